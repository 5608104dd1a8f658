// A run whose missions lie in the stores of a batch system's tasks, to be read as one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/files/temporary_file.h"

namespace ed3r::store {

struct AddingStores {
  std::vector<std::string> dirs;
  std::vector<std::string> notes;  // a line each on shards that are not counted, as they are of another plan
};

// RUN, where it has a store, and the stores of RUN/shards that hold missions or failures which RUN does not. Compares recipes
// and keys. A shard of another plan, also of one that has grown since, is left out with a note where RUN is complete without it.
// UserError where RUN is not, and where a store cannot be read.
AddingStores StoresThatAdd(const std::string& run_dir);

// Joins the stores of RUN/shards, and RUN's own where it has one, into a folder in $TMPDIR that goes with this object; a run
// without shards, or that they have nothing to add to, is read where it is. Changes nothing in RUN. UserError where the stores do not belong together.
class GatheredShards {
 public:
  explicit GatheredShards(const std::string& run_dir);

  const std::string& dir() const { return dir_; }                   // of one store
  const std::vector<std::string>& notes() const { return notes_; }  // as AddingStores

 private:
  std::string dir_;
  std::optional<TemporaryFolder> temporary_;
  std::vector<std::string> notes_;
};

}  // namespace ed3r::store
