#include "engine/mission/samples.h"

#include <algorithm>
#include <array>

#include "engine/agents/features.h"
#include "engine/agents/reward.h"

namespace ed3r::mission {
namespace {

// State and action side by side, as the networks see them.
template <class State, class Action>
auto RowOf(const State& state, const Action& action) {
  std::array<float, std::tuple_size_v<State> + std::tuple_size_v<Action>> row{};
  std::transform(state.begin(), state.end(), row.begin(),
                 [](double value) { return static_cast<float>(value); });
  std::copy(action.begin(), action.end(), row.begin() + static_cast<std::ptrdiff_t>(state.size()));
  return row;
}

robot::MotionCommand CommandOf(const TimestepRecord& step) {
  return {.displacement_m = {step.command_dx_m, step.command_dy_m, step.command_dz_m},
          .turn_rad = step.command_turn_rad,
          .tilt_rad = step.command_tilt_rad};
}

agents::RcView StartView(const MissionRecord& record) {
  agents::RcView view;
  view.pose = {{record.start_x_m, record.start_y_m, record.start_z_m}, record.start_yaw_rad, 0.0};
  view.rc_distance_m = record.start_rc_distance_m;
  return view;
}

// The RC's view of the next timestep.
agents::RcView ViewAfter(const TimestepRecord& step) {
  agents::RcView view;
  view.pose = {{step.x_m, step.y_m, step.z_m}, step.yaw_rad, step.tilt_rad};
  view.rc_distance_m = step.rc_distance_m;
  view.previous_scs = step.scs;
  view.previous_energy_j = step.total_j;
  return view;
}

agents::RobotView OnboardView(const TimestepRecord& step, const agents::RcView& before, double battery_j,
                              const Config& flown) {
  agents::RobotView view;
  view.yaw_rad = step.yaw_rad;
  view.tilt_rad = step.tilt_rad;
  view.battery_ratio = battery_j / flown.robot.BatteryJ();
  view.cpu_ratio = step.cpu_hz / flown.cpu.frequency_max_hz;
  view.rc_distance_m = step.rc_distance_m;
  view.bandwidth_hz = step.bandwidth_hz;
  view.rate_bps = step.rate_bps;
  view.previous_scs = before.previous_scs;
  view.previous_energy_j = before.previous_energy_j;
  return view;
}

}  // namespace

void AppendSamples(const MissionRecord& record, std::int64_t mission_id, const Config& flown,
                   const AgentsConfig& agents, rfnn::DataSet& rc, rfnn::DataSet& robot) {
  agents::RcView before = StartView(record);
  double battery_j = flown.robot.BatteryJ();
  for (const TimestepRecord& step : record.steps) {
    const auto target = static_cast<float>(agents::Reward(agents, step.total_j, step.scs, battery_j));
    rc.Add(RowOf(agents::StateOf(before), agents::ActionOf(CommandOf(step))), target, mission_id);
    robot.Add(RowOf(agents::StateOf(OnboardView(step, before, battery_j, flown)),
                    agents::ActionOf(static_cast<agents::Execution>(step.execution))),
              target, mission_id);
    before = ViewAfter(step);
    battery_j = step.battery_j;
  }
}

}  // namespace ed3r::mission
