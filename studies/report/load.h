// Reads a run directory for its report.
#pragma once

#include <string>

#include "studies/report/report.h"

namespace ed3r {

// Throws UserError when there is no store.
RunResults LoadRun(const std::string& dir);

}  // namespace ed3r
