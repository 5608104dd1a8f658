#include "studies/metrics/definitions.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/suggest.h"

namespace ed3r::metrics {
namespace {

using M = mission::MissionRecord;
using G = MetricGroup;
using E = Estimate;

constexpr double kKilojoule = 1e-3, kMinute = 1.0 / 60, kPercent = 100, kAsIs = 1;
constexpr double kTenMinutes_s = 600;  // the paper's "critical detection window"

double One(const M&) { return 1; }
double Timesteps(const M& m) { return static_cast<double>(m.timesteps); }
double Energy(const M& m) { return m.total_j; }
double Duration(const M& m) { return m.duration_s; }
bool Ended(const M& m, mission::Outcome how) { return m.outcome == static_cast<std::int64_t>(how); }

// Movement energy includes hovering while the robot senses, computes and transmits (R5). The Full model runs
// at the remote controller when a timestep is offloaded (A44). A mission fails by battery depletion or by
// a false positive, and all of its energy is wasted (R28).
constexpr MetricDefinition kMetrics[] = {
    {"total_energy_kj", G::kEnergy, "total", "kJ", 2, E::kMean, kKilojoule, Energy, One},
    {"movement_energy_kj", G::kEnergy, "movement, hovering", "kJ", 2, E::kMean, kKilojoule,
     [](const M& m) { return m.movement_j; }, One},
    {"computation_energy_kj", G::kEnergy, "computation", "kJ", 3, E::kMean, kKilojoule,
     [](const M& m) { return m.computation_j; }, One},
    {"transmission_energy_kj", G::kEnergy, "transmission", "kJ", 3, E::kMean, kKilojoule,
     [](const M& m) { return m.transmission_j; }, One},
    {"sensing_energy_kj", G::kEnergy, "sensing", "kJ", 3, E::kMean, kKilojoule,
     [](const M& m) { return m.sensing_j; }, One},
    {"mscs_pct", G::kDetection, "confidence (MSCS)", "%", 2, E::kRatio, kPercent,
     [](const M& m) { return m.reliable_scs_sum; },
     [](const M& m) { return static_cast<double>(m.reliable_timesteps); }},
    {"msr_pct", G::kOutcome, "success (MSR)", "%", 2, E::kRate, kPercent,
     [](const M& m) { return Ended(m, mission::Outcome::kSuccess) ? 1.0 : 0.0; }, One},
    {"wer_pct", G::kOutcome, "wasted energy (WER)", "%", 2, E::kShareOfEnergy, kPercent,
     [](const M& m) { return Ended(m, mission::Outcome::kSuccess) ? 0.0 : m.total_j; }, Energy},
    {"fp_pct", G::kOutcome, "false positive (FP)", "%", 2, E::kRate, kPercent,
     [](const M& m) { return Ended(m, mission::Outcome::kFalsePositive) ? 1.0 : 0.0; }, One},
    {"bd_pct", G::kOutcome, "battery depleted (BD)", "%", 2, E::kRate, kPercent,
     [](const M& m) { return Ended(m, mission::Outcome::kBatteryDepleted) ? 1.0 : 0.0; }, One},
    {"or_pct", G::kDecisions, "offloaded (OR)", "%", 2, E::kShareOfTimesteps, kPercent,
     [](const M& m) { return static_cast<double>(m.offloads); }, Timesteps},
    {"model_full_pct", G::kDecisions, "Full model", "%", 2, E::kShareOfTimesteps, kPercent,
     [](const M& m) { return static_cast<double>(m.offloads + m.full_local); }, Timesteps},
    {"model_quant_pct", G::kDecisions, "Quantized model", "%", 2, E::kShareOfTimesteps, kPercent,
     [](const M& m) { return static_cast<double>(m.quantized_local); }, Timesteps},
    {"lf_accuracy_pct", G::kDecisions, "look-forward accuracy", "%", 2, E::kLookForward, kPercent,
     [](const M& m) { return m.absolute_reward_error_sum; },
     [](const M& m) { return static_cast<double>(m.predicted_timesteps); }},
    {"er_pct", G::kDecisions, "explored (ER)", "%", 2, E::kShareOfTimesteps, kPercent,
     [](const M& m) { return static_cast<double>(m.random_motions); }, Timesteps},
    {"duration_mean_min", G::kTime, "mission, mean", "min", 2, E::kMean, kMinute, Duration, One},
    {"duration_p85_min", G::kTime, "mission, 85 % under", "min", 2, E::kPercentile85, kMinute, Duration, One},
    {"duration_max_min", G::kTime, "mission, longest", "min", 2, E::kMaximum, kMinute, Duration, One},
    {"within_10min_pct", G::kTime, "within 10 min", "%", 2, E::kRate, kPercent,
     [](const M& m) { return m.duration_s <= kTenMinutes_s ? 1.0 : 0.0; }, One},
    {"timesteps_mean", G::kTime, "timesteps per mission", "", 2, E::kMean, kAsIs, Timesteps, One},
    {"seconds_per_timestep", G::kTime, "one timestep", "s", 2, E::kRatio, kAsIs, Duration, Timesteps},
    {"mean_power_w", G::kTime, "mean power", "W", 1, E::kRatio, kAsIs, Energy, Duration},
};

}  // namespace

std::span<const MetricDefinition> MetricDefinitions() { return kMetrics; }

std::string CheckMetricName(const std::string& name) {
  std::vector<std::string> names;
  for (const MetricDefinition& metric : kMetrics)
    if (metric.estimate != Estimate::kMaximum) names.emplace_back(metric.name);
  if (std::find(names.begin(), names.end(), name) != names.end()) return "";
  const std::string nearest = NearestWord(name, names);
  return fmt::format("metric: '{}' is not allowed; allowed: {}{}", name, fmt::join(names, " | "),
                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest));
}

std::size_t MetricIndex(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kMetrics); ++i)
    if (kMetrics[i].name == name) return i;
  FailCheck(__FILE__, __LINE__, "a metric's name", std::string(name));
}

std::string_view GroupTitle(MetricGroup group) {
  switch (group) {
    case G::kEnergy:
      return "Energy per mission";
    case G::kDetection:
      return "Detection";
    case G::kOutcome:
      return "Outcome";
    case G::kDecisions:
      return "Decisions";
    case G::kTime:
      return "Time and power";
  }
  return "";
}

}  // namespace ed3r::metrics
