// Which missions several stores hold together: a run and the shards that are not merged into it yet. Counts each mission once
// and compares nothing with its checksum, so that a million missions take a second ('ed3r verify' compares).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/reader.h"
#include "engine/store/recipe.h"

namespace ed3r::store {

class Tally {
 public:
  Tally(const Recipe& recipe, const RunLayout& layout);

  // UserError when it is of another plan or other code (part_of_run.h), or names a mission that is not in its plan. The
  // missions of a plan that the tally's has grown from are counted as what they are in this one.
  void Add(const std::string& dir);

  // Without times, which are of records. A mission that failed in one store and is done in another is done.
  std::vector<ArmStatus> Arms() const;

 private:
  // `of`: the layout of the store.
  void Mark(Connection& database, const RunLayout& of, const char* table,
            std::vector<std::vector<bool>>& marks) const;

  Recipe recipe_;
  RunLayout layout_;
  std::vector<std::vector<bool>> done_, failed_;  // by run, then mission
};

// The rate at which a store grows: missions that its last session has stored, per second since it began; 0 unless the session
// is open and the file was written within the last `still_s` seconds.
double MissionsPerSecond(const std::string& dir, double still_s);

}  // namespace ed3r::store
