// Results on disk: one SQLite file, DIR/results.sqlite, with the recipe, missions and timesteps of a run.
//
// Threads: one ResultStore is used by one thread at a time (the scheduler's writer); readers open the file
// themselves. Errors: UserError for a directory that holds another recipe, is not a store, or cannot be
// written.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "engine/mission/record.h"
#include "engine/sweep/plan.h"

namespace ed3r {

// What made the results. `identity` must be equal for stores to be continued or merged; `notes` may differ
// (CPU, compiler, SIMD level, library versions, time) and is kept per session.
struct Recipe {
  std::string plan_text;                      // SweepPlan::CanonicalText()
  std::string code_version;                   // commit, with a dirty flag and source hash
  std::map<std::string, std::string> worlds;  // world file -> scene fingerprint
  std::map<std::string, std::string> notes;
};

// A mission that threw. Its scenario and seed are in the plan.
struct FailedMission {
  RunId id;
  std::string message;
};

class ResultStore {
 public:
  enum class Mode { kCreateOrContinue, kReadOnly };

  // kCreateOrContinue makes DIR and the file when missing; refuses a file with another recipe.
  static std::unique_ptr<ResultStore> Open(const std::string& dir, const Recipe& recipe,
                                           const SweepPlan& plan);
  static std::unique_ptr<ResultStore> OpenReadOnly(const std::string& dir);
  virtual ~ResultStore() = default;

  virtual std::set<RunId> Stored() const = 0;  // finished missions; failed ones are flown again
  virtual void Put(const RunId& id, const MissionRecord& record, double wall_s) = 0;
  virtual void PutFailure(const FailedMission& failure) = 0;
  virtual void Commit() = 0;  // everything put so far survives a kill
};

}  // namespace ed3r
