// Is a number of ours the same as the paper's, in size? An equivalence test: the margin within which two numbers count as
// the same is fixed beforehand, and the difference has an interval that holds the chance of both experiments, ours and
// the paper's. A wide interval therefore never makes a number agree.
//
// Pure functions, any thread.
#pragma once

#include "studies/paper/arms.h"
#include "studies/paper/claims.h"

namespace ed3r::claims {

// 10 % of a size, 5 points of a percentage. A claim whose words are vague ("about 3 %", "nearly double") brings the margin by
// which they were read, wider or narrower.
inline constexpr double kMarginShare = 0.10, kMarginPoints = 5.0;
double MarginOf(double paper, bool is_percentage);
double MarginOf(const paper::Claim& claim, double paper);
bool IsPercentage(const paper::Claim& claim);

// Missions of an arm in the paper, and of a P85 group: 15 % of 850 are 128, but the three success rates that it prints of such
// groups are 49, 46 and 47 of 64 (R30). What chance leaves open of its numbers is taken from the spread of our missions.
inline constexpr double kPaperMissions = paper::kPaperOnlineMissions, kPaperMissionsInP85 = 64;

enum class SizeVerdict {
  kEquivalent,  // all of the interval lies within the margin, which begins where the rounding ends
  kImprecise,   // the interval holds no difference at all, but reaches beyond the margin
  kDiffers      // the interval holds neither
};

// Ours minus the paper's.
struct SizeDifference {
  double margin = 0.0;
  double lo = 0.0, hi = 0.0;  // 95 %
  SizeVerdict verdict = SizeVerdict::kDiffers;
};

// `ours` in [lo, hi] (95 %; both `ours` where it is known exactly); `paper_sd`: standard error of the paper's value (NaN:
// none); `rounding`: half of its last printed digit. Where lo or hi is NaN nothing is known: kImprecise with no interval.
SizeDifference CompareSizes(double ours, double lo, double hi, double paper, double paper_sd, double rounding,
                            double margin);

}  // namespace ed3r::claims
