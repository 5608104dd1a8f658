// What missions are expected to take, for plans and batch scripts.
#pragma once

#include "engine/sweep/plan.h"

namespace ed3r::app {

// Seconds of one core for one mission of the arm, on this engine's reference machine.
double ExpectedCoreS(const sweep::Arm& arm);

// For all missions of a stage; 0 for a training stage.
double ExpectedCoreS(const sweep::Stage& stage);

}  // namespace ed3r::app
