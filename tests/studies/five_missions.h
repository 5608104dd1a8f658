// An arm of five missions whose metrics can be worked out by hand.
//
//   mission                1      2      3          4          5
//   outcome             success success false pos. depleted success     sums
//   timesteps              4     10      6         70         10       100
//   duration, s           60    150     90       1080        600      1980
//   total, kJ            7.6     20     12      139.4         61       240
//   reliable, their SCS  2,1.8  3,2.4  2,1.5      0,0        3,2.7    10,8.4
//   mean absolute error  0.2    0.4    0.1        0.8          -
#pragma once

#include "studies/metrics/arm.h"

namespace ed3r {

inline mission::MissionRecord FlownMission(mission::Outcome outcome, std::int64_t offloads, std::int64_t full,
                                           std::int64_t quantized, double duration_s) {
  mission::MissionRecord m;
  m.outcome = static_cast<std::int64_t>(outcome);
  m.offloads = offloads, m.full_local = full, m.quantized_local = quantized;
  m.timesteps = offloads + full + quantized;
  m.duration_s = duration_s;
  return m;
}

inline void SpendEnergy(mission::MissionRecord& m, double movement_j, double computation_j,
                        double transmission_j, double sensing_j) {
  m.movement_j = movement_j, m.computation_j = computation_j;
  m.transmission_j = transmission_j, m.sensing_j = sensing_j;
  m.total_j = movement_j + computation_j + transmission_j + sensing_j;
}

inline void Detect(mission::MissionRecord& m, std::int64_t reliable, double scs_sum,
                   std::int64_t random_motions) {
  m.reliable_timesteps = reliable, m.reliable_scs_sum = scs_sum, m.random_motions = random_motions;
}

inline void Predict(mission::MissionRecord& m, std::int64_t timesteps, double absolute_error_sum) {
  m.predicted_timesteps = timesteps, m.absolute_reward_error_sum = absolute_error_sum;
}

inline metrics::ArmData FiveMissions() {
  metrics::ArmData arm{.stage = "online", .name = "ed3r-75", .missions = {}, .failed = 1, .missing = 2};
  mission::MissionRecord one = FlownMission(mission::Outcome::kSuccess, 1, 2, 1, 60);
  SpendEnergy(one, 7000, 300, 200, 100), Detect(one, 2, 1.8, 1), Predict(one, 4, 0.8);
  one.site_known = 1, one.base_station_known = 1;
  mission::MissionRecord two = FlownMission(mission::Outcome::kSuccess, 2, 6, 2, 150);
  SpendEnergy(two, 19000, 600, 150, 250), Detect(two, 3, 2.4, 0), Predict(two, 10, 4);
  two.base_station_known = 1;
  mission::MissionRecord three = FlownMission(mission::Outcome::kFalsePositive, 3, 3, 0, 90);
  SpendEnergy(three, 11000, 350, 500, 150), Detect(three, 2, 1.5, 2), Predict(three, 6, 0.6);
  three.site_known = 1;
  mission::MissionRecord four = FlownMission(mission::Outcome::kBatteryDepleted, 10, 40, 20, 1080);
  SpendEnergy(four, 136000, 1500, 150, 1750), Detect(four, 0, 0, 10), Predict(four, 70, 56);
  mission::MissionRecord five = FlownMission(mission::Outcome::kSuccess, 0, 10, 0, 600);
  SpendEnergy(five, 60000, 600, 150, 250), Detect(five, 3, 2.7, 3);
  arm.missions = {one, two, three, four, five};
  return arm;
}

}  // namespace ed3r
