#include "engine/agents/features.h"

#include <cmath>
#include <numbers>

namespace ed3r {
namespace {

double Wrapped(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

}  // namespace

RcState StateOf(const RcView& view) {
  RcState state{};
  state[kRcX] = view.pose.position_m.x();
  state[kRcY] = view.pose.position_m.y();
  state[kRcZ] = view.pose.position_m.z();
  state[kRcYaw] = Wrapped(view.pose.yaw_rad);
  state[kRcTilt] = view.pose.tilt_rad;
  state[kRcDistance] = view.rc_distance_m;
  state[kRcPreviousScs] = view.previous_scs;
  state[kRcPreviousEnergy] = view.previous_energy_j;
  return state;
}

RcAction ActionOf(const MotionCommand& command) {
  RcAction action{};
  action[kRcMoveX - kRcStates] = static_cast<float>(command.displacement_m.x());
  action[kRcMoveY - kRcStates] = static_cast<float>(command.displacement_m.y());
  action[kRcMoveZ - kRcStates] = static_cast<float>(command.displacement_m.z());
  action[kRcTurn - kRcStates] = static_cast<float>(command.turn_rad);
  action[kRcTiltCommand - kRcStates] = static_cast<float>(command.tilt_rad);
  return action;
}

RobotState StateOf(const RobotView& view) {
  RobotState state{};
  state[kRobotYaw] = Wrapped(view.yaw_rad);
  state[kRobotTilt] = view.tilt_rad;
  state[kRobotBattery] = view.battery_ratio;
  state[kRobotCpu] = view.cpu_ratio;
  state[kRobotDistance] = view.rc_distance_m;
  state[kRobotBandwidth] = view.bandwidth_hz;
  state[kRobotRate] = view.rate_bps;
  state[kRobotPreviousScs] = view.previous_scs;
  state[kRobotPreviousEnergy] = view.previous_energy_j;
  return state;
}

RobotAction ActionOf(Execution execution) { return kRobotActions[static_cast<std::size_t>(execution)]; }

}  // namespace ed3r
