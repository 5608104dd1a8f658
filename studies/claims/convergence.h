// How sure more missions make: the half-width of the tables' 95 % intervals against the number of missions.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/metrics/arm.h"

namespace ed3r::claims {

// One metric of the first `missions` missions of an arm. NaN is "none".
struct ConvergencePoint {
  std::string stage, arm;
  std::string_view metric;
  std::int64_t missions = 0;
  int networks = 0;  // that flew them; 0 where only one or none did
  double value = 0;
  double half_width = 0;  // half of the tables' interval: with the luck of training
  double half_width_missions =
      0;  // over missions alone: goes with 1 / sqrt(missions), the other one ends at the luck
};

// 50, 100, 200, ... and all missions of every arm that has 50; energy, MSR, WER, FP, BD, MSCS and mean
// duration. Missions are taken in mission order, which is balanced over places and networks.
std::vector<ConvergencePoint> Convergence(std::span<const metrics::ArmData> arms);

// Columns stage,arm,metric,missions,networks,value,half_width,half_width_missions.
std::string ConvergenceCsv(const std::vector<ConvergencePoint>& points);

}  // namespace ed3r::claims
