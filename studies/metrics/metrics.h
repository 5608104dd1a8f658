// The metrics of one arm, with 95 % intervals.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/metrics/arm.h"
#include "studies/metrics/definitions.h"

namespace ed3r::metrics {

// A value and its interval, in the metric's unit. NaN is "none": no value from an empty sample (or where no
// network predicted), no interval from fewer than two missions or for a maximum.
struct MetricValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
  std::int64_t n = 0;  // missions that the value rests on
};

struct ArmMetrics {
  std::string stage, name;
  std::int64_t missions = 0;  // flown; failed and missing ones as in ArmData
  std::int64_t failed = 0, missing = 0;
  int networks = 0;                 // trained with different seeds; 0 where intervals know of one or none
  std::vector<MetricValue> values;  // in the order of MetricDefinitions()

  const MetricValue& operator[](std::string_view metric) const { return values[MetricIndex(metric)]; }
};

// Where missions flew with several networks (training.seeds), every interval includes the luck of training
// (and of the warm-up, with training.own_warmups): it is at
// least as wide as Student's t over the networks' own values.
//
// Everything of MetricDefinitions() for the missions of `arm`, failed and successful ones alike (R9).
// Pure. Checks every record first (ED3R_CHECK): counts within the timesteps, a known outcome, finite energies
// whose parts sum up to the total.
ArmMetrics ComputeMetrics(const ArmData& arm);

// Of the arm's P85 group (P85Group). Its look-forward accuracy is relative to the worst mission of all that the arm's
// networks flew, as the paper's must be: its P85 value is higher than the mean.
ArmMetrics ComputeP85(const ArmData& arm);

// The largest mean error of a mission, by network.
using WorstErrors = std::map<std::int64_t, double>;
WorstErrors WorstErrorsOf(std::span<const mission::MissionRecord> missions);

// LF accuracy of each mission (R29): 1 - MAE / the largest MAE of its network in `worst`; 1 where no prediction was off, NaN
// where there was none.
std::vector<double> LookForwardAccuracies(std::span<const mission::MissionRecord> missions,
                                          const WorstErrors& worst);

}  // namespace ed3r::metrics
