// What a batch run still owes, by its stores alone: what a scheduler says of its jobs is no result.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/schedule/batch/steps.h"
#include "engine/schedule/progress_of_stage.h"

namespace ed3r::schedule {

struct Owed {
  int step = 0;                     // from this one on, counted from 1; 0 when nothing is owed
  std::vector<std::int64_t> tasks;  // of that step, where it is an array
  std::int64_t missions = 0;        // that these tasks have not stored
};

// Reads the run, its shards and the cache. A failed mission is owed: its task flies it again.
Owed WhatIsOwed(const sweep::SweepPlan& plan, const std::vector<BatchStep>& steps, const std::string& run_dir,
                const std::string& cache_dir, const HalfWidthFn& half_width);

}  // namespace ed3r::schedule
