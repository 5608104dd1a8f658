#include "studies/variants/paired.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "studies/metrics/definitions.h"
#include "studies/statistics/intervals.h"

namespace ed3r::variants {
namespace {

double ValueOf(const mission::MissionRecord& mission, const metrics::MetricDefinition& metric) {
  return metric.scale * metric.part(mission) / metric.whole(mission);
}

using ByNetwork = std::map<std::int64_t, std::vector<double>>;

// What the scenarios that both flew say. A network's values are those of the pairs that it flew; the differences stand twice, by
// the networks of either arm.
struct Pairs {
  std::vector<double> base, difference;
  ByNetwork base_by_network, other_by_network, difference_by_base, difference_by_other;
  std::set<std::pair<std::int64_t, std::int64_t>> networks;  // that met
};

Pairs PairsOf(const metrics::ArmData& base, const metrics::ArmData& other,
              const metrics::MetricDefinition& metric) {
  std::map<std::int64_t, const mission::MissionRecord*> others;
  for (const mission::MissionRecord& mission : other.missions) others[mission.scenario] = &mission;
  Pairs pairs;
  for (const mission::MissionRecord& mission : base.missions) {
    const auto found = others.find(mission.scenario);
    if (found == others.end()) continue;
    const double before = ValueOf(mission, metric), after = ValueOf(*found->second, metric);
    pairs.base.push_back(before);
    pairs.difference.push_back(after - before);
    const std::int64_t network = mission.network, other_network = found->second->network;
    pairs.networks.insert({network, other_network});
    if (network >= 0) {
      pairs.base_by_network[network].push_back(before);
      pairs.difference_by_base[network].push_back(after - before);
    }
    if (other_network >= 0) {
      pairs.other_by_network[other_network].push_back(after);
      pairs.difference_by_other[other_network].push_back(after - before);
    }
  }
  return pairs;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::vector<double> MeansOf(const ByNetwork& by_network) {
  std::vector<double> means;
  for (const auto& [network, values] : by_network) means.push_back(Mean(values));
  return means;
}

// What a sample of differences says of their mean.
struct Finding {
  statistics::Interval interval = {};
  double p = std::numeric_limits<double>::quiet_NaN();
};

Finding FindingOf(const std::vector<double>& differences) {
  return {statistics::MeanInterval(differences), statistics::MeanP(differences)};
}

// Of networks, each by the mean of its differences. Where they coincide their luck adds nothing to that of the missions.
Finding FindingOfNetworks(const std::vector<double>& means) {
  if (std::all_of(means.begin(), means.end(), [&](double x) { return x == means.front(); }))
    return {{means.front(), means.front()}, means.front() == 0.0 ? 1.0 : 0.0};
  return FindingOf(means);
}

// Variance of the mean of a sample of at least two.
double VarianceOfMean(const std::vector<double>& sample) {
  const double mean = Mean(sample), n = static_cast<double>(sample.size());
  double squares = 0.0;
  for (const double x : sample) squares += (x - mean) * (x - mean);
  return squares / (n * (n - 1.0));
}

// Welch's t between two sets of networks, around a difference.
Finding WelchFinding(const std::vector<double>& a, const std::vector<double>& b, double difference) {
  const double va = VarianceOfMean(a), vb = VarianceOfMean(b), v = va + vb;
  if (v <= 0.0) return {{difference, difference}, difference == 0.0 ? 1.0 : 0.0};
  const double degrees =
      v * v / (va * va / static_cast<double>(a.size() - 1) + vb * vb / static_cast<double>(b.size() - 1));
  const double half = statistics::StudentT95(degrees) * std::sqrt(v);
  return {{difference - half, difference + half}, statistics::StudentP(difference / std::sqrt(v), degrees)};
}

// Of the networks' luck; does not exist where none flew, or a single one on either side.
Finding NetworkFinding(const Pairs& pairs, double difference) {
  const std::vector<double> base = MeansOf(pairs.base_by_network), other = MeansOf(pairs.other_by_network);
  if (base.size() == 1 || other.size() == 1 || (base.empty() && other.empty())) return {};
  if (other.empty()) return FindingOfNetworks(MeansOf(pairs.difference_by_base));
  if (base.empty()) return FindingOfNetworks(MeansOf(pairs.difference_by_other));
  // Each network met one of the other side alone: what they share goes out of the differences.
  if (pairs.networks.size() == base.size() && base.size() == other.size())
    return FindingOfNetworks(MeansOf(pairs.difference_by_base));
  return WelchFinding(base, other, difference);
}

// What decides where a mission begins and what it looks for.
auto PlaceOf(const mission::MissionRecord& m) {
  return std::tuple(m.site, m.base_station, m.start_x_m, m.start_y_m, m.start_z_m, m.start_yaw_rad);
}

}  // namespace

PairedDifference DifferenceOf(const metrics::ArmData& base, const metrics::ArmData& other,
                              std::string_view metric) {
  const Pairs pairs = PairsOf(base, other, metrics::MetricDefinitions()[metrics::MetricIndex(metric)]);
  PairedDifference result;
  result.pairs = static_cast<int>(pairs.difference.size());
  result.base = pairs.base.empty() ? std::numeric_limits<double>::quiet_NaN() : Mean(pairs.base);
  result.difference = pairs.base.empty() ? result.base : Mean(pairs.difference);
  result.base_networks = static_cast<int>(pairs.base_by_network.size());
  result.networks = static_cast<int>(pairs.other_by_network.size());
  auto [interval, p] = FindingOf(pairs.difference);
  if (const Finding networks = NetworkFinding(pairs, result.difference); networks.interval.Exists()) {
    interval = {std::min(interval.lo, networks.interval.lo), std::max(interval.hi, networks.interval.hi)};
    p = std::max(p, networks.p);
  }
  result.lo = interval.lo;
  result.hi = interval.hi;
  result.p = p;
  return result;
}

bool SameScenarios(const metrics::ArmData& a, const metrics::ArmData& b) {
  std::map<std::int64_t, const mission::MissionRecord*> others;
  for (const mission::MissionRecord& mission : b.missions) others[mission.scenario] = &mission;
  return std::all_of(a.missions.begin(), a.missions.end(), [&](const mission::MissionRecord& mission) {
    const auto found = others.find(mission.scenario);
    return found == others.end() || PlaceOf(*found->second) == PlaceOf(mission);
  });
}

std::size_t ScenariosInCommon(const metrics::ArmData& a, const metrics::ArmData& b) {
  std::set<std::int64_t> scenarios;
  for (const mission::MissionRecord& mission : a.missions) scenarios.insert(mission.scenario);
  return static_cast<std::size_t>(std::count_if(
      b.missions.begin(), b.missions.end(),
      [&](const mission::MissionRecord& mission) { return scenarios.contains(mission.scenario); }));
}

bool FewInCommon(const metrics::ArmData& a, const metrics::ArmData& b) {
  return ScenariosInCommon(a, b) < std::min(a.missions.size(), b.missions.size());
}

bool OtherWorlds(const metrics::ArmData& a, const metrics::ArmData& b) {
  return !a.world.empty() && !b.world.empty() && a.world != b.world;
}

}  // namespace ed3r::variants
