// How far a flying stage is by what is stored, and what it asks next: decided anew from the store each time, so that any
// process comes to the same answer.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/sweep/plan.h"

namespace ed3r::schedule {

// Half of the width of the 95 % interval that the first `missions` missions of an arm, all stored in `dir`, give for a
// metric, in its unit; NaN where they give none. The arm by its name: where the plan is about to grow, it has another number
// in `dir`.
using HalfWidthFn = std::function<double(const std::string& dir, int stage, const std::string& arm,
                                         int missions, const std::string& metric)>;

struct StageProgress {
  std::vector<int> open;     // arms that are asked for more missions; none when the stage is finished
  int upto = 0;              // their missions below this number are due
  std::int64_t missing = 0;  // of those, how many are not stored

  // Whether a mission of this stage is due, stored or not.
  bool Asks(const sweep::RunId& id) const;
};

// `stored`: what `dir` holds, sorted. Without a precision every arm with a missing mission is open. With one, `upto` ends
// the first round that is not wholly stored, and arms known well enough by the rounds before it are closed. A training
// stage is never open. InternalError when the plan has no such stage.
StageProgress ProgressOf(const sweep::SweepPlan& plan, const std::string& stage,
                         const std::vector<sweep::RunId>& stored, const std::string& dir,
                         const HalfWidthFn& half_width);

// UserError, where a stage that `stage` builds on is not finished, that names it and how many missions it lacks.
void CheckReady(const sweep::SweepPlan& plan, const sweep::Stage& stage,
                const std::vector<sweep::RunId>& stored, const std::string& dir,
                const HalfWidthFn& half_width);

}  // namespace ed3r::schedule
