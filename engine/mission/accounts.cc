#include "engine/mission/accounts.h"

#include <algorithm>
#include <cmath>

namespace ed3r::mission {

double MovementJ(const TimestepRecord& s) {
  return s.horizontal_j + s.ascent_j + s.descent_j + s.hover_turning_j + s.hover_sensing_j +
         s.hover_computing_j + s.hover_transmitting_j;
}

double DurationS(const TimestepRecord& s) {
  return s.horizontal_s + s.ascent_s + s.descent_s + s.turning_s + s.sensing_s + s.computing_s +
         s.transmitting_s;
}

TimestepRecord OpenStep(std::uint32_t k, const agents::MotionDecision& motion, const robot::FlownMove& move,
                        const agents::ExecutionDecision& execution) {
  TimestepRecord step;
  step.k = k;
  step.command_dx_m = motion.command.displacement_m.x();
  step.command_dy_m = motion.command.displacement_m.y();
  step.command_dz_m = motion.command.displacement_m.z();
  step.command_turn_rad = motion.command.turn_rad;
  step.command_tilt_rad = motion.command.tilt_rad;
  step.motion_rule = static_cast<std::int64_t>(motion.rule);
  step.band = static_cast<std::int64_t>(motion.band);
  step.epsilon = motion.epsilon;
  step.rc_predicted_reward = motion.predicted_reward;
  step.x_m = move.end.position_m.x();
  step.y_m = move.end.position_m.y();
  step.z_m = move.end.position_m.z();
  step.yaw_rad = move.end.yaw_rad;
  step.tilt_rad = move.end.tilt_rad;
  step.halted = move.halted ? 1 : 0;
  step.contact_steps = move.contact_steps;
  step.execution = static_cast<std::int64_t>(execution.execution);
  step.execution_random = execution.random ? 1 : 0;
  step.robot_predicted_reward = execution.predicted_reward;
  return step;
}

void RecordLink(const Conditions& conditions, double rc_distance_m, const radio::Link& link,
                TimestepRecord& step) {
  step.cpu_hz = conditions.cpu_hz;
  step.bandwidth_hz = conditions.bandwidth_hz;
  step.shadowing_db = conditions.shadowing_db;
  step.rc_distance_m = rc_distance_m;
  step.rate_bps = link.rate_bps;
  step.transmit_power_w = link.transmit_power_w;
}

void RecordLedger(const robot::StepTime& time, const robot::StepEnergy& energy, double battery_left_j,
                  TimestepRecord& step) {
  step.horizontal_s = time.horizontal_s;
  step.ascent_s = time.ascent_s;
  step.descent_s = time.descent_s;
  step.turning_s = time.turning_s;
  step.sensing_s = time.sensing_s;
  step.computing_s = time.computing_s;
  step.transmitting_s = time.transmitting_s;
  step.horizontal_j = energy.horizontal_j;
  step.ascent_j = energy.ascent_j;
  step.descent_j = energy.descent_j;
  step.hover_turning_j = energy.hover_turning_j;
  step.hover_sensing_j = energy.hover_sensing_j;
  step.hover_computing_j = energy.hover_computing_j;
  step.hover_transmitting_j = energy.hover_transmitting_j;
  step.sensing_j = energy.sensing_j;
  step.computation_j = energy.computation_j;
  step.transmission_j = energy.transmission_j;
  step.total_j = energy.TotalJ();
  step.battery_j = battery_left_j;
}

void SumSteps(double eta_min, MissionRecord& record) {
  record.timesteps = static_cast<std::int64_t>(record.steps.size());
  for (const TimestepRecord& step : record.steps) {
    record.duration_s += DurationS(step);
    record.movement_j += MovementJ(step);
    record.sensing_j += step.sensing_j;
    record.computation_j += step.computation_j;
    record.transmission_j += step.transmission_j;
    record.total_j += step.total_j;
    record.contact_steps += step.contact_steps;
    record.halts += step.halted;
    record.offloads += step.execution == static_cast<std::int64_t>(agents::Execution::kOffload);
    record.full_local += step.execution == static_cast<std::int64_t>(agents::Execution::kFull);
    record.quantized_local += step.execution == static_cast<std::int64_t>(agents::Execution::kQuantized);
    record.random_motions += step.motion_rule == static_cast<std::int64_t>(agents::MotionRule::kRandom);
    record.reward_sum += step.reward;
    if (step.scs >= eta_min) {
      ++record.reliable_timesteps;
      record.reliable_scs_sum += step.scs;
    }
    if (!std::isnan(step.rc_predicted_reward)) {
      ++record.predicted_timesteps;
      const double error = std::abs(step.rc_predicted_reward - step.reward);
      record.absolute_reward_error_sum += error;
      record.largest_reward_error = std::max(record.largest_reward_error, error);
    }
  }
}

}  // namespace ed3r::mission
