#include "studies/claims/luck.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "studies/claims/equivalence.h"
#include "studies/statistics/intervals.h"

namespace ed3r::claims {
namespace {

// The scale on which networks spread alike: logit for percentages of one arm, the number itself for all else.
struct Scale {
  bool logit = false;

  double To(double value) const {
    if (!logit) return value;
    const double share = std::clamp(value / 100.0, 1e-3, 1.0 - 1e-3);
    return std::log(share / (1.0 - share));
  }
  double From(double value) const { return logit ? 100.0 / (1.0 + std::exp(-value)) : value; }
  double SlopeAt(double value) const {
    if (!logit) return 1.0;
    const double share = std::clamp(value / 100.0, 1e-3, 1.0 - 1e-3);
    return 0.01 / (share * (1.0 - share));
  }
};

// What one network's missions say of its share: half a mission is added on either side, as a network that found all of 28
// fires is not one that finds every fire.
struct NetworkValue {
  double value = 0, variance = 0;  // on the scale; NaN where the variance is not known
};

NetworkValue ValueOf(const Judgement& network, const Scale& scale) {
  if (!scale.logit || network.missions == 0)
    return {scale.To(network.ours), std::pow(scale.SlopeAt(network.ours) * network.own_sd, 2)};
  const auto missions = static_cast<double>(network.missions);
  const double share = (network.ours / 100.0 * missions + 0.5) / (missions + 1.0), pct = 100.0 * share;
  if (network.own_sd == 0.0) return {scale.To(pct), 1.0 / ((missions + 1.0) * share * (1.0 - share))};
  return {scale.To(pct), std::pow(scale.SlopeAt(pct) * network.own_sd, 2)};
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

Luck LuckOf(const JudgedClaim& judged) {
  const auto paper = paper::PaperValueOf(judged.claim);
  if (judged.all.verdict != Verdict::kDiffers || !paper) return Luck::kNone;
  const Scale scale{IsPercentage(judged.claim) && judged.claim.kind != "ratio"};
  std::vector<double> values, own_variances, paper_variances;
  for (const Judgement& network : judged.by_network) {
    if (std::isnan(network.ours)) continue;
    const NetworkValue known = ValueOf(network, scale);
    values.push_back(known.value);
    if (std::isnan(known.variance)) continue;
    own_variances.push_back(known.variance);
    paper_variances.push_back(std::pow(scale.SlopeAt(paper->value) * network.paper_sd, 2));
  }
  if (values.size() < 2 || !judged.asks_networks) return Luck::kUnknown;
  const auto count = static_cast<double>(values.size());
  const double mean = Mean(values);
  double spread = 0.0;
  for (const double value : values) spread += (value - mean) * (value - mean) / (count - 1.0);
  // Each network's value holds the chance of its own missions; the paper's holds that of 850.
  double variance = spread, of_a_network = spread;
  if (!own_variances.empty()) {
    variance = std::max(0.0, spread - Mean(own_variances)) + Mean(paper_variances);
    of_a_network = std::max(spread, Mean(own_variances));  // few networks may lie close by chance
  }
  const double reach = statistics::StudentT95(count - 1.0) * std::sqrt(variance + of_a_network / count);
  const double lo = scale.From(mean - reach) - paper->half_unit;
  const double hi = scale.From(mean + reach) + paper->half_unit;
  if (paper->value < lo || hi < paper->value) return Luck::kNone;
  return hi - lo > kWidestLuck * MarginOf(judged.claim, paper->value) ? Luck::kTooWide : Luck::kWithin;
}

}  // namespace ed3r::claims
