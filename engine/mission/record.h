// What a mission leaves behind: one row, and one row per timestep. Plain data with one description that
// store, digest, CSV and JSON share; columns are int64, double or text. Rates and means are never stored,
// only what happened.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/agents/decisions.h"
#include "engine/config/field.h"

namespace ed3r::mission {

enum class Outcome : std::int64_t { kSuccess = 0, kFalsePositive = 1, kBatteryDepleted = 2 };

}  // namespace ed3r::mission

namespace ed3r {

template <>
struct EnumNames<mission::Outcome> {
  static constexpr EnumName<mission::Outcome> kNames[] = {
      {mission::Outcome::kSuccess, "success"},
      {mission::Outcome::kFalsePositive, "false-positive"},
      {mission::Outcome::kBatteryDepleted, "battery-depleted"}};
};

}  // namespace ed3r

namespace ed3r::mission {

struct TimestepRecord {
  std::int64_t k = 0;  // 1, 2, ...
  // Command and what came of it
  double command_dx_m = 0, command_dy_m = 0, command_dz_m = 0, command_turn_rad = 0, command_tilt_rad = 0;
  std::int64_t motion_rule = 0;  // MotionRule
  std::int64_t band = 0;         // ConfidenceBand
  double epsilon = 0;
  double x_m = 0, y_m = 0, z_m = 0, yaw_rad = 0, tilt_rad = 0;  // after the move
  std::int64_t halted = 0, contact_steps = 0;
  // Draws and link
  double cpu_hz = 0, bandwidth_hz = 0, shadowing_db = 0, rc_distance_m = 0, rate_bps = 0,
         transmit_power_w = 0;
  std::int64_t execution = 0;  // Execution
  std::int64_t execution_random = 0;
  // Detection
  double confidence_mean = 0, confidence_sd = 0, scs = 0;
  double fire_only_scs = 0;  // what flame and smoke in view would have reached without distractors (R16)
  double fire_share = 0, smoke_share = 0;  // visible share of the image
  std::int64_t fire_in_view = 0;
  // Times
  double horizontal_s = 0, ascent_s = 0, descent_s = 0, turning_s = 0, sensing_s = 0, computing_s = 0,
         transmitting_s = 0;
  // Energies (Eqs. 1, 3, 6, 9); hovering by what it waits for
  double horizontal_j = 0, ascent_j = 0, descent_j = 0, hover_turning_j = 0, hover_sensing_j = 0,
         hover_computing_j = 0, hover_transmitting_j = 0, sensing_j = 0, computation_j = 0,
         transmission_j = 0, total_j = 0;
  double battery_j = 0;  // left after the timestep
  // Reward (Eq. 21) and what the agents expected; NaN where no network was asked
  double reward = 0, rc_predicted_reward = 0, robot_predicted_reward = 0;

  template <class Self, class Visitor>
  static void Describe(Self& s, Visitor&& visit);
};

struct MissionRecord {
  std::int64_t scenario = 0, site = 0, base_station = 0;
  std::int64_t network = -1;  // which of its arm's training seeds; -1 without networks
  std::int64_t site_known = 0, base_station_known = 0;
  std::int64_t outcome = 0;  // Outcome
  std::int64_t timesteps = 0;
  double duration_s = 0;
  double movement_j = 0, sensing_j = 0, computation_j = 0, transmission_j = 0, total_j = 0;
  double battery_left_j = 0;
  double distance_m = 0;
  std::int64_t contact_steps = 0, halts = 0;
  std::int64_t reliable_timesteps = 0;  // SCS >= eta_min
  double reliable_scs_sum = 0;          // sum of their SCS (R15)
  std::int64_t offloads = 0, full_local = 0, quantized_local = 0;
  std::int64_t random_motions = 0;  // timesteps with a random RC action (R20)
  double reward_sum = 0, absolute_reward_error_sum = 0;
  double largest_reward_error = 0;       // of one timestep, absolute
  std::int64_t predicted_timesteps = 0;  // timesteps with an RC prediction (R29)
  double start_x_m = 0, start_y_m = 0, start_z_m = 0, start_yaw_rad = 0, start_rc_distance_m = 0;

  std::vector<TimestepRecord> steps;  // stored in a table of their own

  template <class Self, class Visitor>
  static void Describe(Self& s, Visitor&& visit);
};

template <class Self, class Visitor>
void TimestepRecord::Describe(Self& s, Visitor&& visit) {
  visit("k", s.k), visit("command_dx_m", s.command_dx_m), visit("command_dy_m", s.command_dy_m);
  visit("command_dz_m", s.command_dz_m), visit("command_turn_rad", s.command_turn_rad);
  visit("command_tilt_rad", s.command_tilt_rad), visit("motion_rule", s.motion_rule), visit("band", s.band);
  visit("epsilon", s.epsilon), visit("x_m", s.x_m), visit("y_m", s.y_m), visit("z_m", s.z_m);
  visit("yaw_rad", s.yaw_rad), visit("tilt_rad", s.tilt_rad), visit("halted", s.halted);
  visit("contact_steps", s.contact_steps), visit("cpu_hz", s.cpu_hz), visit("bandwidth_hz", s.bandwidth_hz);
  visit("shadowing_db", s.shadowing_db), visit("rc_distance_m", s.rc_distance_m),
      visit("rate_bps", s.rate_bps);
  visit("transmit_power_w", s.transmit_power_w), visit("execution", s.execution);
  visit("execution_random", s.execution_random), visit("confidence_mean", s.confidence_mean);
  visit("confidence_sd", s.confidence_sd), visit("scs", s.scs), visit("fire_only_scs", s.fire_only_scs);
  visit("fire_share", s.fire_share);
  visit("smoke_share", s.smoke_share), visit("fire_in_view", s.fire_in_view),
      visit("horizontal_s", s.horizontal_s);
  visit("ascent_s", s.ascent_s), visit("descent_s", s.descent_s), visit("turning_s", s.turning_s);
  visit("sensing_s", s.sensing_s), visit("computing_s", s.computing_s),
      visit("transmitting_s", s.transmitting_s);
  visit("horizontal_j", s.horizontal_j), visit("ascent_j", s.ascent_j), visit("descent_j", s.descent_j);
  visit("hover_turning_j", s.hover_turning_j), visit("hover_sensing_j", s.hover_sensing_j);
  visit("hover_computing_j", s.hover_computing_j), visit("hover_transmitting_j", s.hover_transmitting_j);
  visit("sensing_j", s.sensing_j), visit("computation_j", s.computation_j),
      visit("transmission_j", s.transmission_j);
  visit("total_j", s.total_j), visit("battery_j", s.battery_j), visit("reward", s.reward);
  visit("rc_predicted_reward", s.rc_predicted_reward),
      visit("robot_predicted_reward", s.robot_predicted_reward);
}

template <class Self, class Visitor>
void MissionRecord::Describe(Self& s, Visitor&& visit) {
  visit("scenario", s.scenario), visit("site", s.site), visit("base_station", s.base_station),
      visit("network", s.network);
  visit("site_known", s.site_known), visit("base_station_known", s.base_station_known),
      visit("outcome", s.outcome);
  visit("timesteps", s.timesteps), visit("duration_s", s.duration_s), visit("movement_j", s.movement_j);
  visit("sensing_j", s.sensing_j), visit("computation_j", s.computation_j),
      visit("transmission_j", s.transmission_j);
  visit("total_j", s.total_j), visit("battery_left_j", s.battery_left_j), visit("distance_m", s.distance_m);
  visit("contact_steps", s.contact_steps), visit("halts", s.halts),
      visit("reliable_timesteps", s.reliable_timesteps);
  visit("reliable_scs_sum", s.reliable_scs_sum), visit("offloads", s.offloads),
      visit("full_local", s.full_local);
  visit("quantized_local", s.quantized_local), visit("random_motions", s.random_motions);
  visit("reward_sum", s.reward_sum), visit("absolute_reward_error_sum", s.absolute_reward_error_sum);
  visit("largest_reward_error", s.largest_reward_error);
  visit("predicted_timesteps", s.predicted_timesteps), visit("start_x_m", s.start_x_m),
      visit("start_y_m", s.start_y_m);
  visit("start_z_m", s.start_z_m), visit("start_yaw_rad", s.start_yaw_rad),
      visit("start_rc_distance_m", s.start_rc_distance_m);
}

}  // namespace ed3r::mission
