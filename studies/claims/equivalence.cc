#include "studies/claims/equivalence.h"

#include <algorithm>
#include <cmath>

namespace ed3r {
namespace {

constexpr double kNormal95 = 1.959964;

double OrZero(double value) { return std::isnan(value) ? 0.0 : value; }

}  // namespace

bool IsPercentage(const Claim& claim) { return claim.unit.starts_with('%'); }

double MarginOf(double paper, bool is_percentage) {
  return is_percentage ? kMarginPoints : kMarginShare * std::abs(paper);
}

double MarginOf(const Claim& claim, double paper) {
  return std::max(MarginOf(paper, IsPercentage(claim)), claim.tolerance);
}

SizeDifference CompareSizes(double ours, double lo, double hi, double paper, double paper_sd, double rounding,
                            double margin) {
  const double difference = ours - paper;
  const double of_paper = kNormal95 * OrZero(paper_sd);
  SizeDifference result{.margin = margin,
                        .lo = difference - std::hypot(OrZero(ours - lo), of_paper) - rounding,
                        .hi = difference + std::hypot(OrZero(hi - ours), of_paper) + rounding};
  if (-margin - rounding <= result.lo && result.hi <= margin + rounding)
    result.verdict = SizeVerdict::kEquivalent;
  else if (result.lo <= 0.0 && 0.0 <= result.hi)
    result.verdict = SizeVerdict::kImprecise;
  return result;
}

}  // namespace ed3r
