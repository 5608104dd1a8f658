#include "studies/claims/evidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "studies/claims/equivalence.h"
#include "studies/metrics/definitions.h"
#include "studies/paper/arms.h"

namespace ed3r::claims {
namespace {

struct Weight {
  double p_for = 1, p_against = 1;
  const Formula* leaf = nullptr;  // the part that decides
};

Quantity Difference(const Formula& leaf) {
  // As claimed is positive: right - left for "left < right".
  const bool less = leaf.kind == Formula::Kind::kLess;
  return {.kind = Quantity::Kind::kSubtract,
          .number = 0,
          .cell = {},
          .of = {less ? leaf.right : leaf.left, less ? leaf.left : leaf.right}};
}

Weight WeighLeaf(const Formula& leaf, double tolerance, const ResampledArms& arms) {
  const statistics::Resampled difference = arms.Of(Difference(leaf));
  const statistics::Uncertainty uncertainty = statistics::UncertaintyOf(difference);
  if (leaf.kind == Formula::Kind::kLess) {
    const statistics::Sides sides = statistics::TestAgainst(difference, uncertainty, 0);
    return {sides.above, sides.below, &leaf};
  }
  // Similar: two one-sided tests against the ends of the tolerance.
  const statistics::Sides upper = statistics::TestAgainst(difference, uncertainty, tolerance);
  const statistics::Sides lower = statistics::TestAgainst(difference, uncertainty, -tolerance);
  return {std::max(upper.below, lower.above), std::min(upper.above, lower.below), &leaf};
}

Weight Weigh(const Formula& formula, double tolerance, const ResampledArms& arms) {
  if (formula.of.empty()) return WeighLeaf(formula, tolerance, arms);
  const bool all = formula.kind == Formula::Kind::kAll;
  std::vector<Weight> parts;
  for (const Formula& part : formula.of) parts.push_back(Weigh(part, tolerance, arms));
  // p_for is 1 for every part that leans the other way: of those the surer one counts.
  const auto by_for = [](const Weight& a, const Weight& b) {
    return std::pair(a.p_for, -a.p_against) < std::pair(b.p_for, -b.p_against);
  };
  const auto by_against = [](const Weight& a, const Weight& b) { return a.p_against < b.p_against; };
  const auto count = static_cast<double>(parts.size());
  const auto least_for = std::min_element(parts.begin(), parts.end(), by_for);
  const auto most_for = std::max_element(parts.begin(), parts.end(), by_for);
  const auto least_against = std::min_element(parts.begin(), parts.end(), by_against);
  const auto most_against = std::max_element(parts.begin(), parts.end(), by_against);
  if (all) return {most_for->p_for, std::min(1.0, count * least_against->p_against), most_for->leaf};
  return {std::min(1.0, count * least_for->p_for), most_against->p_against, least_for->leaf};
}

// The paper's own value of a cell, give or take its rounding.
struct Printed {
  double value = kNoNumber, half_unit = 0;
};

Printed PaperDifference(const Formula& leaf, const std::vector<paper::Claim>& claims) {
  Printed printed;
  printed.value = ValueOf(Difference(leaf), [&](const Cell& cell) {
    const auto paper =
        paper::FindPaperValue(claims, cell.arm, metrics::MetricDefinitions()[cell.metric].name);
    if (!paper) return kNoNumber;
    printed.half_unit += paper->half_unit;
    return paper->value;
  });
  return printed;
}

bool HasAlternatives(const Formula& formula) {
  return formula.kind == Formula::Kind::kAny ||
         std::any_of(formula.of.begin(), formula.of.end(), HasAlternatives);
}

// A product or quotient of percentages is none.
bool IsLinear(const Quantity& quantity) {
  return quantity.kind != Quantity::Kind::kMultiply && quantity.kind != Quantity::Kind::kDivide &&
         std::all_of(quantity.of.begin(), quantity.of.end(), IsLinear);
}

bool SizesAgree(const Formula& formula, const ResampledArms& arms, const std::vector<paper::Claim>& claims) {
  if (HasAlternatives(formula)) return false;
  bool any = false;
  for (const Formula* leaf : LeavesOf(formula)) {
    const Printed paper = PaperDifference(*leaf, claims);
    if (std::isnan(paper.value)) return false;
    const Quantity difference = Difference(*leaf);
    const statistics::Resampled ours = arms.Of(difference);
    const statistics::Uncertainty uncertainty = statistics::UncertaintyOf(ours);
    const std::vector<Cell> cells = CellsOf(difference);
    const bool percentage =
        metrics::MetricDefinitions()[cells.front().metric].unit == "%" && IsLinear(difference);
    const SizeDifference size = CompareSizes(ours.value, uncertainty.lo, uncertainty.hi, paper.value,
                                             uncertainty.sd_missions * arms.ToPaperSize(cells),
                                             paper.half_unit, MarginOf(paper.value, percentage));
    if (size.verdict != SizeVerdict::kEquivalent) return false;
    any = true;
  }
  return any;
}

bool IsPlainCell(const Quantity& quantity) { return quantity.kind == Quantity::Kind::kCell; }

// The chance of a share at the paper's own value: ours may be one that our missions happen not to show, or that leaves less or
// more to chance than the paper's. A ratio of sums (wasted energy) keeps what it varies beyond a plain share of missions.
double SdOfShareAt(double paper_pct, double ours_pct, double sd_of_ours, double missions) {
  const auto variance = [](double pct) {
    const double share = std::clamp(pct / 100.0, 0.0, 1.0);
    return share * (1.0 - share);
  };
  if (std::isnan(sd_of_ours) || variance(ours_pct) == 0.0)
    return 100.0 * std::sqrt(variance(paper_pct) / missions);
  return sd_of_ours * std::sqrt(variance(paper_pct) / variance(ours_pct));
}

double PaperSdOf(const Cell& cell, double paper, double ours, double sd_of_ours) {
  const double missions = paper::IsP85Name(cell.arm) ? kPaperMissionsInP85 : kPaperMissions;
  const metrics::MetricDefinition& metric = metrics::MetricDefinitions()[cell.metric];
  if (std::isnan(paper)) return sd_of_ours;
  if (metric.estimate == metrics::Estimate::kRate) return SdOfShareAt(paper, kNoNumber, kNoNumber, missions);
  return metric.name == "wer_pct" ? SdOfShareAt(paper, ours, sd_of_ours, missions) : sd_of_ours;
}

}  // namespace

Evidence WeighOrder(const paper::Claim& claim, const Formula& formula, const ResampledArms& arms,
                    const std::vector<paper::Claim>& claims) {
  const Weight weight = Weigh(formula, claim.tolerance, arms);
  Evidence evidence;
  evidence.directional = true;
  evidence.p_for = weight.p_for, evidence.p_against = weight.p_against;
  const statistics::Resampled difference = arms.Of(Difference(*weight.leaf));
  const statistics::Uncertainty uncertainty = statistics::UncertaintyOf(difference);
  evidence.ours = difference.value, evidence.lo = uncertainty.lo, evidence.hi = uncertainty.hi;
  evidence.paper = PaperDifference(*weight.leaf, claims).value;
  evidence.sizes_agree = SizesAgree(formula, arms, claims);
  evidence.detail = TextOf(*weight.leaf);
  return evidence;
}

Evidence WeighNumber(const paper::Claim& claim, const Quantity& quantity, const ResampledArms& arms) {
  Evidence evidence;
  if (const auto paper = paper::PaperValueOf(claim)) evidence.paper = paper->value;
  const statistics::Resampled number = arms.Of(quantity);
  const statistics::Uncertainty uncertainty = statistics::UncertaintyOf(number);
  evidence.own_sd = uncertainty.sd_missions;
  evidence.missions = number.units;
  evidence.paper_sd = uncertainty.sd_missions * arms.ToPaperSize(CellsOf(quantity));
  if (IsPlainCell(quantity) && !paper::IsP85Name(quantity.cell.arm)) {
    const metrics::MetricValue& ours = arms.TableValue(quantity.cell);
    evidence.ours = ours.value, evidence.lo = ours.lo, evidence.hi = ours.hi;
    evidence.exact =
        metrics::MetricDefinitions()[quantity.cell.metric].estimate == metrics::Estimate::kMaximum;
    evidence.paper_sd = PaperSdOf(quantity.cell, evidence.paper, evidence.ours, evidence.paper_sd);
    return evidence;
  }
  evidence.ours = number.value, evidence.lo = uncertainty.lo, evidence.hi = uncertainty.hi;
  if (IsPlainCell(quantity))
    evidence.paper_sd = PaperSdOf(quantity.cell, evidence.paper, evidence.ours, evidence.paper_sd);
  if (claim.kind != "ratio") {
    // Student's t may leave what is possible.
    if (evidence.lo < 0) evidence.lo = 0;
    if (claim.unit.starts_with('%') && evidence.hi > 100) evidence.hi = 100;
    return evidence;
  }
  evidence.directional = true;
  const double no_difference = quantity.kind == Quantity::Kind::kDivide ? 1 : 0;
  const statistics::Sides sides = statistics::TestAgainst(number, uncertainty, no_difference);
  const bool more = evidence.paper > no_difference;
  evidence.p_for = more ? sides.above : sides.below;
  evidence.p_against = more ? sides.below : sides.above;
  return evidence;
}

}  // namespace ed3r::claims
