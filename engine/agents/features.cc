#include "engine/agents/features.h"

#include <cmath>
#include <numbers>

namespace ed3r::agents {
namespace {

double Wrapped(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

}  // namespace

RcState StateOf(const RcView& view) {
  RcState state{};
  state[rfnn::kRcX] = view.pose.position_m.x();
  state[rfnn::kRcY] = view.pose.position_m.y();
  state[rfnn::kRcZ] = view.pose.position_m.z();
  state[rfnn::kRcYaw] = Wrapped(view.pose.yaw_rad);
  state[rfnn::kRcTilt] = view.pose.tilt_rad;
  state[rfnn::kRcDistance] = view.rc_distance_m;
  state[rfnn::kRcPreviousScs] = view.previous_scs;
  state[rfnn::kRcPreviousEnergy] = view.previous_energy_j;
  return state;
}

RcAction ActionOf(const robot::MotionCommand& command) {
  RcAction action{};
  action[rfnn::kRcMoveX - rfnn::kRcStates] = static_cast<float>(command.displacement_m.x());
  action[rfnn::kRcMoveY - rfnn::kRcStates] = static_cast<float>(command.displacement_m.y());
  action[rfnn::kRcMoveZ - rfnn::kRcStates] = static_cast<float>(command.displacement_m.z());
  action[rfnn::kRcTurn - rfnn::kRcStates] = static_cast<float>(command.turn_rad);
  action[rfnn::kRcTiltCommand - rfnn::kRcStates] = static_cast<float>(command.tilt_rad);
  return action;
}

RobotState StateOf(const RobotView& view) {
  RobotState state{};
  state[rfnn::kRobotYaw] = Wrapped(view.yaw_rad);
  state[rfnn::kRobotTilt] = view.tilt_rad;
  state[rfnn::kRobotBattery] = view.battery_ratio;
  state[rfnn::kRobotCpu] = view.cpu_ratio;
  state[rfnn::kRobotDistance] = view.rc_distance_m;
  state[rfnn::kRobotBandwidth] = view.bandwidth_hz;
  state[rfnn::kRobotRate] = view.rate_bps;
  state[rfnn::kRobotPreviousScs] = view.previous_scs;
  state[rfnn::kRobotPreviousEnergy] = view.previous_energy_j;
  return state;
}

RobotAction ActionOf(Execution execution) { return rfnn::kRobotActions[static_cast<std::size_t>(execution)]; }

}  // namespace ed3r::agents
