// The results of a run directory, as the report needs them.
#pragma once

#include <future>
#include <string>

#include "studies/report/report.h"

namespace ed3r::report {

// Every arm of the flying stages of the store in `dir`, in plan order, with its missions (without timesteps)
// and how many failed or are missing; training stages are left out. The run may still be going on: a mission
// that is stored while this reads counts as flown or as missing. Throws UserError where there is no store or
// a damaged one.
RunResults LoadRun(const std::string& dir);

// Begins to compare everything that the store in `dir` holds with its checksums, by a thread of its own. get() waits and gives
// the digest (ResultReader::CheckWhole), or throws UserError where there is no store or a damaged one.
std::future<std::string> CheckWhole(const std::string& dir);

// Half of the width of a metric's 95 % interval over the first `missions` missions of an arm; NaN where they give none
// or are not all stored. For stages with a precision (engine/sweep/plan.h).
double HalfWidth(const std::string& dir, int stage, const std::string& arm, int missions,
                 const std::string& metric);

}  // namespace ed3r::report
