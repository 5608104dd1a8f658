#include "studies/claims/equivalence.h"

#include <cmath>

namespace ed3r::claims {
namespace {

constexpr double kNormal95 = 1.959964;

}  // namespace

bool IsPercentage(const paper::Claim& claim) { return claim.unit.starts_with('%') || claim.unit == "points"; }

double MarginOf(double paper, bool is_percentage) {
  return is_percentage ? kMarginPoints : kMarginShare * std::abs(paper);
}

double MarginOf(const paper::Claim& claim, double paper) {
  return claim.tolerance > 0 ? claim.tolerance : MarginOf(paper, IsPercentage(claim));
}

SizeDifference CompareSizes(double ours, double lo, double hi, double paper, double paper_sd, double rounding,
                            double margin) {
  const double difference = ours - paper;
  const double of_paper = std::isnan(paper_sd) ? 0.0 : kNormal95 * paper_sd;
  SizeDifference result{.margin = margin,
                        .lo = difference - std::hypot(ours - lo, of_paper) - rounding,
                        .hi = difference + std::hypot(hi - ours, of_paper) + rounding};
  if (std::isnan(result.lo) || std::isnan(result.hi))
    result.verdict = SizeVerdict::kImprecise;
  else if (-margin - rounding <= result.lo && result.hi <= margin + rounding)
    result.verdict = SizeVerdict::kEquivalent;
  else if (result.lo <= 0.0 && 0.0 <= result.hi)
    result.verdict = SizeVerdict::kImprecise;
  return result;
}

}  // namespace ed3r::claims
