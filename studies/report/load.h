// The results of a run directory, as the report needs them.
#pragma once

#include <string>

#include "studies/report/report.h"

namespace ed3r {

// Every arm of the flying stages of the store in `dir`, in plan order, with its missions (without timesteps)
// and how many failed or are missing; training stages are left out. The run may still be going on: a mission
// that is stored while this reads counts as flown or as missing. Throws UserError where there is no store or
// a damaged one.
RunResults LoadRun(const std::string& dir);

}  // namespace ed3r
