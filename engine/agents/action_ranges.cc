#include "engine/agents/action_ranges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/check.h"

namespace ed3r::agents {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

ActionRanges ActionRanges::Full(const AgentsConfig& agents) {
  return {agents.axis_range_m, agents.yaw_range_deg * kDegree, agents.tilt_range_deg * kDegree};
}

ActionRanges ActionRanges::Decreased(const AgentsConfig& agents) const {
  if (agents.range_rule == RangeRule::kPercent)
    return {axis_m * (1.0 - agents.decrease_axes / 100.0), yaw_rad * (1.0 - agents.decrease_yaw / 100.0),
            tilt_rad * (1.0 - agents.decrease_tilt / 100.0)};
  return {axis_m / agents.decrease_axes, yaw_rad / agents.decrease_yaw, tilt_rad / agents.decrease_tilt};
}

ActionRanges ActionRanges::Increased(const AgentsConfig& agents) const {
  ActionRanges wider;
  if (agents.range_rule == RangeRule::kPercent) {
    wider = {axis_m * (1.0 + agents.decrease_axes / 100.0), yaw_rad * (1.0 + agents.decrease_yaw / 100.0),
             tilt_rad * (1.0 + agents.decrease_tilt / 100.0)};
  } else {
    wider = {axis_m + agents.decrease_axes, yaw_rad + agents.decrease_yaw * kDegree,
             tilt_rad + agents.decrease_tilt * kDegree};
  }
  const ActionRanges full = Full(agents);
  return {std::min(wider.axis_m, full.axis_m), std::min(wider.yaw_rad, full.yaw_rad),
          std::min(wider.tilt_rad, full.tilt_rad)};
}

TiltInterval TiltCommands(const ActionRanges& ranges, const AgentsConfig& agents, double tilt_rad) {
  const double full_rad = agents.tilt_range_deg * kDegree;
  if (agents.tilt_command == TiltCommand::kAbsolute && ranges.tilt_rad >= full_rad) return {0.0, full_rad};
  return {std::clamp(tilt_rad - 0.5 * ranges.tilt_rad, 0.0, full_rad),
          std::clamp(tilt_rad + 0.5 * ranges.tilt_rad, 0.0, full_rad)};
}

robot::MotionCommand DrawCommand(const ActionRanges& ranges, const AgentsConfig& agents, double tilt_rad,
                                 Stream& stream) {
  robot::MotionCommand command;
  for (int axis = 0; axis < 3; ++axis)
    command.displacement_m[axis] = stream.Uniform(-ranges.axis_m, ranges.axis_m);
  command.turn_rad = stream.Uniform(-ranges.yaw_rad, ranges.yaw_rad);
  const TiltInterval tilt = TiltCommands(ranges, agents, tilt_rad);
  command.tilt_rad = stream.Uniform(tilt.low_rad, tilt.high_rad);
  return command;
}

robot::MotionCommand Clamped(const robot::MotionCommand& command, const ActionRanges& ranges,
                             const AgentsConfig& agents, double tilt_rad) {
  if (!command.displacement_m.allFinite() || !std::isfinite(command.turn_rad) ||
      !std::isfinite(command.tilt_rad))
    throw UserError("a motion command is not finite");
  robot::MotionCommand inside = command;
  for (int axis = 0; axis < 3; ++axis)
    inside.displacement_m[axis] = std::clamp(command.displacement_m[axis], -ranges.axis_m, ranges.axis_m);
  inside.turn_rad = std::clamp(command.turn_rad, -ranges.yaw_rad, ranges.yaw_rad);
  const TiltInterval tilt = TiltCommands(ranges, agents, tilt_rad);
  inside.tilt_rad = std::clamp(command.tilt_rad, tilt.low_rad, tilt.high_rad);
  return inside;
}

}  // namespace ed3r::agents
