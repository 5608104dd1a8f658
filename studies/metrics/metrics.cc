#include "studies/metrics/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "engine/core/check.h"
#include "studies/statistics/intervals.h"

namespace ed3r::metrics {
namespace {

void CheckRecord(const ArmData& arm, const mission::MissionRecord& m) {
  const auto here = [&] { return fmt::format("arm {}, scenario {}", arm.name, m.scenario); };
  ED3R_CHECK(NameOf(static_cast<mission::Outcome>(m.outcome)) != "?", here());
  ED3R_CHECK(m.offloads >= 0 && m.full_local >= 0 && m.quantized_local >= 0, here());
  ED3R_CHECK(m.offloads + m.full_local + m.quantized_local == m.timesteps, here());
  for (const std::int64_t count : {m.reliable_timesteps, m.random_motions, m.predicted_timesteps})
    ED3R_CHECK(0 <= count && count <= m.timesteps, here());
  for (const double size : {m.duration_s, m.movement_j, m.sensing_j, m.computation_j, m.transmission_j,
                            m.total_j, m.reliable_scs_sum, m.absolute_reward_error_sum})
    ED3R_CHECK(std::isfinite(size) && size >= 0, here());
  // Equal but for rounding: the ledger adds timesteps in one order, this sum adds parts in another.
  const double parts = m.movement_j + m.sensing_j + m.computation_j + m.transmission_j;
  ED3R_CHECK(std::abs(parts - m.total_j) <= 1e-6 * (1 + m.total_j), here());
}

// Of the RC network's predictions in one mission that has any.
double MeanErrorOf(const mission::MissionRecord& m) {
  return m.absolute_reward_error_sum / static_cast<double>(m.predicted_timesteps);
}

// What the missions contribute to one metric.
struct Contributions {
  std::vector<double> part, whole;
};

Contributions Collect(const MetricDefinition& metric, const std::vector<mission::MissionRecord>& missions) {
  Contributions all;
  for (const mission::MissionRecord& mission : missions) {
    const double whole = metric.whole(mission);
    if (whole == 0) continue;
    all.part.push_back(metric.part(mission));
    all.whole.push_back(whole);
  }
  return all;
}

double Sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

statistics::Interval IntervalOf(Estimate estimate, const Contributions& all) {
  switch (estimate) {
    case Estimate::kMean:
    case Estimate::kLookForward:
      return statistics::MeanInterval(all.part);
    case Estimate::kRate:
      return statistics::RateInterval(std::llround(Sum(all.part)),
                                      static_cast<std::int64_t>(all.part.size()));
    case Estimate::kShareOfTimesteps:
      return statistics::ShareInterval(all.part, all.whole, statistics::ShareUnit::kTimestep);
    case Estimate::kShareOfEnergy:
      return statistics::ShareInterval(all.part, all.whole, statistics::ShareUnit::kMission);
    case Estimate::kRatio:
      return statistics::RatioInterval(all.part, all.whole);
    case Estimate::kPercentile85:
      return statistics::QuantileInterval(all.part, 85);
    case Estimate::kMaximum:
      return {};
  }
  return {};
}

double ValueOf(Estimate estimate, const Contributions& all) {
  if (estimate == Estimate::kMaximum) return all.part.back();
  if (estimate == Estimate::kPercentile85)
    return all.part[statistics::QuantileRank(static_cast<std::int64_t>(all.part.size()), 85) - 1];
  return Sum(all.part) / Sum(all.whole);
}

// Largest possible value; the smallest is 0 for all of them.
double UpperLimit(const MetricDefinition& metric) {
  return metric.unit == "%" ? 1.0 : std::numeric_limits<double>::infinity();
}

MetricValue Evaluate(const MetricDefinition& metric, const std::vector<mission::MissionRecord>& missions,
                     const WorstErrors& worst) {
  Contributions all = Collect(metric, missions);
  MetricValue result;
  result.n = static_cast<std::int64_t>(all.part.size());
  if (result.n == 0) return result;
  if (metric.estimate == Estimate::kLookForward) {
    all.part = LookForwardAccuracies(missions, worst);
    std::erase_if(all.part, [](double accuracy) { return std::isnan(accuracy); });
    all.whole.assign(all.part.size(), 1.0);
  }
  if (metric.estimate == Estimate::kPercentile85 || metric.estimate == Estimate::kMaximum)
    std::sort(all.part.begin(), all.part.end());
  result.value = metric.scale * ValueOf(metric.estimate, all);
  if (const statistics::Interval interval = IntervalOf(metric.estimate, all); interval.Exists()) {
    // A small sample's t interval may leave what is possible.
    result.lo = metric.scale * std::max(0.0, interval.lo);
    result.hi = metric.scale * std::min(UpperLimit(metric), interval.hi);
  }
  return result;
}

// Missions by the network that flew them; one group where none did.
std::vector<std::vector<mission::MissionRecord>> ByNetwork(
    const std::vector<mission::MissionRecord>& missions) {
  std::map<std::int64_t, std::vector<mission::MissionRecord>> groups;
  for (const mission::MissionRecord& mission : missions) groups[mission.network].push_back(mission);
  std::vector<std::vector<mission::MissionRecord>> list;
  for (auto& [network, group] : groups) list.push_back(std::move(group));
  return list;
}

// The luck of training: networks are a sample too, and missions of one network share its luck. Student's t over the
// networks' own values holds both kinds of chance; few networks can agree by accident, so it only ever widens the
// interval over missions.
void WidenByNetworks(const MetricDefinition& metric,
                     const std::vector<std::vector<mission::MissionRecord>>& groups, const WorstErrors& worst,
                     MetricValue& result) {
  if (std::isnan(result.lo)) return;
  std::vector<double> values;
  for (const std::vector<mission::MissionRecord>& group : groups) {
    const double value = Evaluate(metric, group, worst).value;
    if (!std::isnan(value)) values.push_back(value);
  }
  const statistics::Interval between = statistics::MeanInterval(values);
  if (!between.Exists()) return;
  const double half_width = 0.5 * (between.hi - between.lo);
  result.lo = std::min(result.lo, std::max(0.0, result.value - half_width));
  result.hi = std::max(result.hi, std::min(metric.scale * UpperLimit(metric), result.value + half_width));
}

}  // namespace

WorstErrors WorstErrorsOf(std::span<const mission::MissionRecord> missions) {
  WorstErrors worst;
  for (const mission::MissionRecord& m : missions)
    if (m.predicted_timesteps > 0) worst[m.network] = std::max(worst[m.network], MeanErrorOf(m));
  return worst;
}

std::vector<double> LookForwardAccuracies(std::span<const mission::MissionRecord> missions,
                                          const WorstErrors& worst) {
  std::vector<double> accuracies;
  for (const mission::MissionRecord& m : missions) {
    if (m.predicted_timesteps == 0) {
      accuracies.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const double of_network = worst.at(m.network);
    accuracies.push_back(of_network > 0 ? 1 - MeanErrorOf(m) / of_network : 1);
  }
  return accuracies;
}

namespace {

ArmMetrics ComputeWith(const ArmData& arm, const WorstErrors& worst) {
  for (const mission::MissionRecord& mission : arm.missions) CheckRecord(arm, mission);
  ArmMetrics metrics{.stage = arm.stage,
                     .name = arm.name,
                     .missions = static_cast<std::int64_t>(arm.missions.size()),
                     .failed = arm.failed,
                     .missing = arm.missing,
                     .values = {}};
  const std::vector<std::vector<mission::MissionRecord>> groups = ByNetwork(arm.missions);
  metrics.networks = groups.size() > 1 ? static_cast<int>(groups.size()) : 0;
  for (const MetricDefinition& metric : MetricDefinitions()) {
    metrics.values.push_back(Evaluate(metric, arm.missions, worst));
    if (metrics.networks > 1) WidenByNetworks(metric, groups, worst, metrics.values.back());
  }
  return metrics;
}

}  // namespace

ArmMetrics ComputeMetrics(const ArmData& arm) { return ComputeWith(arm, WorstErrorsOf(arm.missions)); }

ArmMetrics ComputeP85(const ArmData& arm) { return ComputeWith(P85Group(arm), WorstErrorsOf(arm.missions)); }

}  // namespace ed3r::metrics
