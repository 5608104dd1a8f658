// A run whose missions lie in the stores of a batch system's tasks, to be read as one.
#pragma once

#include <string>
#include <vector>

namespace ed3r::app {

// RUN, where it has a store, and the stores of RUN/shards that hold missions or failures which RUN does not. Compares keys
// alone. UserError where one cannot be read.
std::vector<std::string> StoresThatAdd(const std::string& run_dir);

// Joins the stores of RUN/shards, and RUN's own where it has one, into a folder in $TMPDIR that goes with this object; a run
// without shards, or that they have nothing to add to, is read where it is. Changes nothing in RUN. UserError where the stores do not belong together.
class GatheredShards {
 public:
  explicit GatheredShards(const std::string& run_dir);
  ~GatheredShards();
  GatheredShards(const GatheredShards&) = delete;
  GatheredShards& operator=(const GatheredShards&) = delete;

  const std::string& dir() const { return dir_; }  // of one store

 private:
  std::string dir_, temporary_;
};

}  // namespace ed3r::app
