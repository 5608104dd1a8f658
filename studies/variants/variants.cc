#include "studies/variants/variants.h"

#include <algorithm>
#include <map>

#include "studies/metrics/definitions.h"
#include "studies/paper/claims.h"
#include "studies/statistics/intervals.h"

namespace ed3r {
namespace {

std::size_t At(const std::string& name) { return name.find('@'); }

std::string VariantOf(const ArmData& arm) {
  return At(arm.name) == std::string::npos ? "" : arm.name.substr(At(arm.name) + 1);
}

double ValueOf(const MissionRecord& mission, const MetricDefinition& metric) {
  return metric.scale * metric.part(mission) / metric.whole(mission);
}

// What each scenario that both flew says, by the network that flew the first.
struct Pairs {
  std::vector<double> base, difference;
  std::map<std::int64_t, std::vector<double>> by_network;
};

Pairs PairsOf(const ArmData& base, const ArmData& other, const MetricDefinition& metric) {
  std::map<std::int64_t, const MissionRecord*> others;
  for (const MissionRecord& mission : other.missions) others[mission.scenario] = &mission;
  Pairs pairs;
  for (const MissionRecord& mission : base.missions) {
    const auto found = others.find(mission.scenario);
    if (found == others.end()) continue;
    pairs.base.push_back(ValueOf(mission, metric));
    pairs.difference.push_back(ValueOf(*found->second, metric) - pairs.base.back());
    pairs.by_network[mission.network].push_back(pairs.difference.back());
  }
  return pairs;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

VariantDifference Compare(const ArmData& base, const ArmData& other, const std::string& variant,
                          const char* metric) {
  const Pairs pairs = PairsOf(base, other, MetricDefinitions()[MetricIndex(metric)]);
  VariantDifference result{base.name, variant, metric};
  result.pairs = static_cast<int>(pairs.difference.size());
  result.base = pairs.base.empty() ? std::numeric_limits<double>::quiet_NaN() : Mean(pairs.base);
  result.difference = pairs.base.empty() ? result.base : Mean(pairs.difference);
  Interval interval = MeanInterval(pairs.difference);
  if (pairs.by_network.size() > 1) {
    std::vector<double> means;
    for (const auto& [network, values] : pairs.by_network) means.push_back(Mean(values));
    const Interval networks = MeanInterval(means);
    interval = {std::min(interval.lo, networks.lo), std::max(interval.hi, networks.hi)};
  }
  result.lo = interval.lo;
  result.hi = interval.hi;
  return result;
}

void AddChanges(const ClaimStudy& base, const ClaimStudy& here, const std::string& variant,
                std::vector<VerdictChange>& changes) {
  for (std::size_t i = 0; i < base.claims.size(); ++i) {
    const Verdict was = base.claims[i].all.verdict, is = here.claims[i].all.verdict;
    if (was != is) changes.push_back({base.claims[i].claim.id, variant, was, is});
  }
}

}  // namespace

std::vector<std::string> VariantsOf(std::span<const ArmData> arms) {
  std::vector<std::string> variants;
  for (const ArmData& arm : arms) {
    const std::string variant = VariantOf(arm);
    if (!variant.empty() && std::find(variants.begin(), variants.end(), variant) == variants.end())
      variants.push_back(variant);
  }
  return variants;
}

std::vector<ArmData> ArmsOfVariant(std::span<const ArmData> arms, const std::string& variant) {
  std::vector<ArmData> own;
  for (const ArmData& arm : arms) {
    if (VariantOf(arm) != variant) continue;
    own.push_back(arm);
    own.back().name.resize(At(arm.name));
  }
  return own;
}

std::vector<ArmData> AsVariant(std::vector<ArmData> arms, const std::string& variant) {
  for (ArmData& arm : arms) arm.name += "@" + variant;
  return arms;
}

VariantStudy CompareVariants(std::span<const ArmData> arms) {
  VariantStudy study;
  study.variants = VariantsOf(arms);
  if (study.variants.empty()) return study;
  const std::vector<ArmData> base = ArmsOfVariant(arms, study.variants.front());
  for (const std::string& variant : study.variants) {
    const std::vector<ArmData> here = ArmsOfVariant(arms, variant);
    study.verdicts.push_back(JudgeClaims(PaperClaims(), here));
    if (variant == study.variants.front()) continue;
    AddChanges(study.verdicts.front(), study.verdicts.back(), variant, study.changes);
    for (const ArmData& arm : base) {
      const auto other = std::find_if(here.begin(), here.end(), [&](const ArmData& candidate) {
        return candidate.stage == arm.stage && candidate.name == arm.name;
      });
      if (other == here.end()) continue;
      for (const char* metric : kComparedMetrics)
        study.differences.push_back(Compare(arm, *other, variant, metric));
    }
  }
  return study;
}

}  // namespace ed3r
