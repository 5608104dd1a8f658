// Views and actions as the networks' inputs (R17). Online decisions and training rows both come through here, so that
// they cannot differ.
#pragma once

#include <array>

#include "engine/agents/decisions.h"
#include "engine/agents/views.h"
#include "engine/rfnn/features.h"
#include "engine/robot/motion.h"

namespace ed3r::agents {

using RcState = std::array<double, rfnn::kRcStates>;
using RcAction = std::array<float, rfnn::kRcInputs - rfnn::kRcStates>;
using RobotState = std::array<double, rfnn::kRobotStates>;
using RobotAction = std::array<float, rfnn::kRobotInputs - rfnn::kRobotStates>;

RcState StateOf(const RcView& view);
RcAction ActionOf(const robot::MotionCommand& command);
RobotState StateOf(const RobotView& view);
RobotAction ActionOf(Execution execution);

}  // namespace ed3r::agents
