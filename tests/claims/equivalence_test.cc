// Equivalence within a margin, by hand-computed cases.
#include "studies/claims/equivalence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ed3r::claims {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(EquivalenceTest, TheDifferenceHoldsTheChanceOfBoth) {
  // Ours 36 +- 0.6, the paper's 35 with a standard error of 0.8 / 1.959964: 1 +- hypot(0.6, 0.8) = 1 +- 1.
  const SizeDifference size = CompareSizes(36, 35.4, 36.6, 35, 0.8 / 1.959964, 0, 3.5);
  EXPECT_NEAR(size.lo, 0.0, 1e-9);
  EXPECT_NEAR(size.hi, 2.0, 1e-9);
  EXPECT_EQ(size.verdict, SizeVerdict::kEquivalent);
}

TEST(EquivalenceTest, FourCases) {
  const auto verdict = [](double ours, double reach) {
    return CompareSizes(ours, ours - reach, ours + reach, 100, kNone, 0, 10).verdict;
  };
  EXPECT_EQ(verdict(103, 6), SizeVerdict::kEquivalent);  // holds zero, inside
  EXPECT_EQ(verdict(106, 2),
            SizeVerdict::kEquivalent);  // certainly not equal, and yet the same within the margin
  EXPECT_EQ(verdict(103, 8), SizeVerdict::kImprecise);  // holds zero, reaches beyond
  EXPECT_EQ(verdict(109, 4), SizeVerdict::kDiffers);    // not zero, not surely inside
  EXPECT_EQ(verdict(130, 4), SizeVerdict::kDiffers);
  EXPECT_EQ(verdict(130, 60), SizeVerdict::kImprecise);
}

TEST(EquivalenceTest, UnevenIntervalsKeepTheirSides) {
  const SizeDifference size = CompareSizes(50, 47, 51, 49, kNone, 0.5, 5);
  EXPECT_NEAR(size.lo, -2.5, 1e-12);
  EXPECT_NEAR(size.hi, 2.5, 1e-12);
}

TEST(EquivalenceTest, ExactNumbersCompareThemselves) {
  EXPECT_EQ(CompareSizes(10.9, 10.9, 10.9, 10, kNone, 0, 1).verdict, SizeVerdict::kEquivalent);
  EXPECT_EQ(CompareSizes(11.1, 11.1, 11.1, 10, kNone, 0, 1).verdict, SizeVerdict::kDiffers);
}

TEST(EquivalenceTest, AMissingIntervalIsNotCertainty) {
  EXPECT_EQ(CompareSizes(10.1, kNone, kNone, 10, kNone, 0, 1).verdict, SizeVerdict::kImprecise);
  EXPECT_EQ(CompareSizes(99, kNone, 99.5, 10, kNone, 0, 1).verdict, SizeVerdict::kImprecise);
}

TEST(EquivalenceTest, Margins) {
  EXPECT_DOUBLE_EQ(MarginOf(34.99, false), 3.499);
  EXPECT_DOUBLE_EQ(MarginOf(97.18, true), 5.0);
  paper::Claim claim;
  claim.unit = "% of missions", claim.tolerance = 7;
  EXPECT_DOUBLE_EQ(MarginOf(claim, 85), 7.0);
  claim.tolerance = 1;  // words may be sharper than the rule as well
  EXPECT_DOUBLE_EQ(MarginOf(claim, 3), 1.0);
  claim.unit = "points", claim.tolerance = 0;
  EXPECT_DOUBLE_EQ(MarginOf(claim, 20.36), 5.0);
  claim.unit = "kJ";
  EXPECT_DOUBLE_EQ(MarginOf(claim, 85), 8.5);
}

}  // namespace
}  // namespace ed3r::claims
