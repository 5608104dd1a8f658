#include "studies/variants/variants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/sweep/arm_id.h"
#include "studies/metrics/definitions.h"
#include "studies/paper/claims.h"
#include "studies/statistics/intervals.h"

namespace ed3r::variants {
namespace {

double ValueOf(const mission::MissionRecord& mission, const metrics::MetricDefinition& metric) {
  return metric.scale * metric.part(mission) / metric.whole(mission);
}

// What the scenarios that both flew say. A network's values are those of the pairs that it flew.
struct Pairs {
  std::vector<double> base, difference;
  std::map<std::int64_t, std::vector<double>> base_by_network, other_by_network, difference_by_network;
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
    if (mission.network >= 0) {
      pairs.base_by_network[mission.network].push_back(before);
      pairs.difference_by_network[mission.network].push_back(after - before);
    }
    if (found->second->network >= 0) pairs.other_by_network[found->second->network].push_back(after);
  }
  return pairs;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::vector<double> MeansOf(const std::map<std::int64_t, std::vector<double>>& by_network) {
  std::vector<double> means;
  for (const auto& [network, values] : by_network) means.push_back(Mean(values));
  return means;
}

// Variance of the mean of a sample of at least two.
double VarianceOfMean(const std::vector<double>& sample) {
  const double mean = Mean(sample), n = static_cast<double>(sample.size());
  double squares = 0.0;
  for (const double x : sample) squares += (x - mean) * (x - mean);
  return squares / (n * (n - 1.0));
}

// Welch's t between two sets of networks, around a difference.
statistics::Interval WelchInterval(const std::vector<double>& a, const std::vector<double>& b,
                                   double difference) {
  const double va = VarianceOfMean(a), vb = VarianceOfMean(b), v = va + vb;
  if (v <= 0.0) return {difference, difference};
  const double degrees =
      v * v / (va * va / static_cast<double>(a.size() - 1) + vb * vb / static_cast<double>(b.size() - 1));
  const double half = statistics::StudentT95(degrees) * std::sqrt(v);
  return {difference - half, difference + half};
}

// Of the networks' luck; does not exist where one of the two flew fewer than two.
statistics::Interval NetworkInterval(const Pairs& pairs, double difference) {
  const std::vector<double> base = MeansOf(pairs.base_by_network), other = MeansOf(pairs.other_by_network);
  if (base.size() < 2 || other.size() < 2) return {};
  if (base.size() == other.size()) return statistics::MeanInterval(MeansOf(pairs.difference_by_network));
  return WelchInterval(base, other, difference);
}

VariantDifference Compare(const metrics::ArmData& base, const metrics::ArmData& other,
                          const std::string& variant, const char* metric) {
  const Pairs pairs = PairsOf(base, other, metrics::MetricDefinitions()[metrics::MetricIndex(metric)]);
  VariantDifference result{base.name, variant, metric};
  result.pairs = static_cast<int>(pairs.difference.size());
  result.base = pairs.base.empty() ? std::numeric_limits<double>::quiet_NaN() : Mean(pairs.base);
  result.difference = pairs.base.empty() ? result.base : Mean(pairs.difference);
  result.base_networks = static_cast<int>(pairs.base_by_network.size());
  result.networks = static_cast<int>(pairs.other_by_network.size());
  statistics::Interval interval = statistics::MeanInterval(pairs.difference);
  if (const statistics::Interval networks = NetworkInterval(pairs, result.difference); networks.Exists())
    interval = {std::min(interval.lo, networks.lo), std::max(interval.hi, networks.hi)};
  result.lo = interval.lo;
  result.hi = interval.hi;
  return result;
}

void AddChanges(const claims::ClaimStudy& base, const claims::ClaimStudy& here, const std::string& variant,
                std::vector<VerdictChange>& changes) {
  for (std::size_t i = 0; i < base.claims.size(); ++i) {
    const claims::Verdict was = base.claims[i].all.verdict, is = here.claims[i].all.verdict;
    const bool luck =
        base.claims[i].luck == claims::Luck::kWithin || here.claims[i].luck == claims::Luck::kWithin;
    if (was != is) changes.push_back({base.claims[i].claim.id, variant, was, is, luck});
  }
}

}  // namespace

std::vector<std::string> VariantsOf(std::span<const metrics::ArmData> arms) {
  std::vector<std::string> variants;
  for (const metrics::ArmData& arm : arms) {
    const std::string variant = sweep::ArmId::Of(arm.name).variant;
    if (!variant.empty() && std::find(variants.begin(), variants.end(), variant) == variants.end())
      variants.push_back(variant);
  }
  return variants;
}

std::vector<metrics::ArmData> ArmsOfVariant(std::span<const metrics::ArmData> arms,
                                            const std::string& variant) {
  std::vector<metrics::ArmData> own;
  for (const metrics::ArmData& arm : arms) {
    const sweep::ArmId id = sweep::ArmId::Of(arm.name);
    if (id.variant != variant) continue;
    own.push_back(arm);
    own.back().name = id.name;
  }
  return own;
}

bool VerdictChange::Contradicts() const {
  if (within_luck) return false;
  return (claims::Holds(base) && here == claims::Verdict::kDiffers) ||
         (base == claims::Verdict::kDiffers && claims::Holds(here));
}

std::vector<metrics::ArmData> AsVariant(std::vector<metrics::ArmData> arms, const std::string& variant) {
  for (metrics::ArmData& arm : arms) arm.name = sweep::ArmId{arm.name, variant}.Text();
  return arms;
}

VariantStudy CompareVariants(std::span<const metrics::ArmData> arms, Verdicts verdicts) {
  VariantStudy study;
  study.variants = VariantsOf(arms);
  if (study.variants.empty()) return study;
  const std::vector<metrics::ArmData> base = ArmsOfVariant(arms, study.variants.front());
  for (const std::string& variant : study.variants) {
    const std::vector<metrics::ArmData> here = ArmsOfVariant(arms, variant);
    if (verdicts == Verdicts::kJudged) {
      study.verdicts.push_back(claims::JudgeClaims(paper::PaperClaims(), here));
      AddChanges(study.verdicts.front(), study.verdicts.back(), variant, study.changes);
    }
    if (variant == study.variants.front()) continue;
    for (const metrics::ArmData& arm : base) {
      const auto other = std::find_if(here.begin(), here.end(), [&](const metrics::ArmData& candidate) {
        return candidate.stage == arm.stage && candidate.name == arm.name;
      });
      if (other == here.end()) continue;
      for (const char* metric : kComparedMetrics)
        study.differences.push_back(Compare(arm, *other, variant, metric));
    }
  }
  return study;
}

}  // namespace ed3r::variants
