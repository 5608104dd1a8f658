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
    const double slope = scale.SlopeAt(network.ours);
    values.push_back(scale.To(network.ours));
    if (std::isnan(network.own_sd)) continue;
    own_variances.push_back(std::pow(slope * network.own_sd, 2));
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
