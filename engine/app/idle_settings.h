// Settings that a sweep makes and that change nothing in it, or less than one would think.
#pragma once

#include <string>
#include <vector>

#include "engine/sweep/plan.h"

namespace ed3r::app {

// A sentence for each reason: which keys are set to another value than their default in some arm, and why no arm of the plan
// heeds them. Empty where every setting acts.
std::vector<std::string> IdleSettings(const sweep::SweepPlan& plan);

}  // namespace ed3r::app
