// Which claims hold without a measurement.
#pragma once

#include "studies/claims/verdicts.h"

namespace ed3r::claims {

// Reproduced by how the study is set up, how an arm is built, or what the paper leaves out: no finding.
bool HoldsByConstruction(const JudgedClaim& judged);

}  // namespace ed3r::claims
