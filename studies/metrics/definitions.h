// The metrics of the paper's evaluation (Table "Evaluation Metrics Definition") and those that its text
// reports, each defined once: its name in files, its place and format in tables, and what every mission
// contributes to it.
//
// All but three are ratios of two totals over the missions of an arm, sum(part) / sum(whole); a mean per
// mission has whole = 1. That is what resampling works on.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/mission/record.h"

namespace ed3r::metrics {

enum class MetricGroup { kEnergy, kDetection, kOutcome, kDecisions, kTime };

// How a value is estimated, and with it the kind of its 95 % interval.
enum class Estimate {
  kMean,              // per mission; Student's t
  kRate,              // share of missions, part is 0 or 1; Wilson
  kShareOfTimesteps,  // pooled over timesteps; Wilson, effective sample size
  kShareOfEnergy,     // of the energy of all missions; Wilson, effective sample size
  kRatio,             // of two totals; linearised
  kPercentile85,      // order statistics
  kMaximum,           // no interval: the largest of a sample says nothing of a larger one
  kLookForward        // LF accuracy (R29); Student's t, given the worst mission
};

struct MetricDefinition {
  std::string_view name;  // in CSV and JSON
  MetricGroup group;
  std::string_view label, unit;  // in tables
  int decimals;                  // in tables
  Estimate estimate;
  double scale;  // from the record's unit to `unit`
  double (*part)(const mission::MissionRecord&);
  double (*whole)(const mission::MissionRecord&);
};

// In the order of the tables. Lives as long as the program.
std::span<const MetricDefinition> MetricDefinitions();

// "" for the name of a metric that has an interval, else a clause that lists them and names the nearest.
std::string CheckMetricName(const std::string& name);

// Position in MetricDefinitions(); ED3R_CHECK that there is one.
std::size_t MetricIndex(std::string_view name);

std::string_view GroupTitle(MetricGroup group);

}  // namespace ed3r::metrics
