// A sweep as steps of a batch system: arrays of independent tasks, and what joins them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/sweep/plan.h"

namespace ed3r::schedule {

struct BatchStep {
  enum class Kind {
    kFly,      // array: each task flies a shard of a stage into a store of its own
    kMerge,    // joins them into the run
    kTrain,    // array: each task trains its networks into the cache
    kCollect,  // puts the networks into the run, for the tasks that fly with them
    kReport
  };
  Kind kind = Kind::kFly;
  std::string name;            // "3-training": of its script
  std::string stage;           // "" for the report
  std::int64_t tasks = 1;      // of an array; 1 for the others
  bool in_rounds = false;      // of a stage with a precision: the merge decides whether it is flown once more
  bool built_upon = false;     // later stages need every mission of this one
  double expected_core_s = 0;  // of the whole step; 0 where nobody knows
};

// Steps in the order in which they run, each after the one before it, numbered from 1 in their names.
// `networks`: how many the training stages train (CountNetworks). `expected_core_s`: what each stage takes, 0 where nobody
// knows.
std::vector<BatchStep> StepsOf(const sweep::SweepPlan& plan, std::int64_t shards, std::int64_t networks,
                               const std::vector<double>& expected_core_s);

// "2,5-7" for the tasks 2, 5, 6 and 7 (ascending).
std::string TaskList(const std::vector<std::int64_t>& tasks);

// Tasks of a step as arrays of at most `limit` indices from 1 on: "1-1000+0", "1-500+1000"; what stands behind the plus
// is added to the index.
std::vector<std::string> ArraysOf(const std::vector<std::int64_t>& tasks, std::int64_t limit);

}  // namespace ed3r::schedule
