#include "studies/statistics/intervals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/core/check.h"

namespace ed3r {
namespace {

using Sample = std::vector<double>;

void ExpectInterval(const statistics::Interval& interval, double lo, double hi, double tolerance) {
  EXPECT_NEAR(interval.lo, lo, tolerance);
  EXPECT_NEAR(interval.hi, hi, tolerance);
}

TEST(StudentT95Test, KnowsItsTable) {
  EXPECT_NEAR(statistics::StudentT95(1), 12.7062047, 1e-7);
  EXPECT_NEAR(statistics::StudentT95(5), 2.5705818, 1e-7);
  EXPECT_NEAR(statistics::StudentT95(30), 2.0422725, 1e-7);
  EXPECT_NEAR(statistics::StudentT95(849), 1.9627621, 1e-7);
  EXPECT_THROW(statistics::StudentT95(0), InternalError);
}

// 15 of 148 and 0 of 20 are the examples of Newcombe (Statistics in Medicine 17, 1998, Table I, method 3).
TEST(RateIntervalTest, IsWilsons) {
  ExpectInterval(statistics::RateInterval(15, 148), 0.0624, 0.1605, 5e-5);
  ExpectInterval(statistics::RateInterval(0, 20), 0.0, 0.1611, 5e-5);
  ExpectInterval(statistics::RateInterval(826, 850), 0.95833074, 0.98095370, 1e-8);
}

TEST(RateIntervalTest, EndsAtNothingAndAllExactlyAndNowhereElse) {
  for (std::int64_t n = 2; n <= 300; ++n) {
    EXPECT_EQ(statistics::RateInterval(0, n).lo, 0.0) << n;
    EXPECT_EQ(statistics::RateInterval(n, n).hi, 1.0) << n;
  }
  EXPECT_NEAR(statistics::RateInterval(1, 10'000).lo, 1.76527e-5, 1e-9);
  EXPECT_NEAR(statistics::RateInterval(9'999, 10'000).hi, 1 - 1.76527e-5, 1e-9);
}

TEST(RateIntervalTest, EndsExactlyAtZeroAndOne) {
  EXPECT_EQ(statistics::RateInterval(0, 850).lo, 0.0);
  EXPECT_NEAR(statistics::RateInterval(0, 850).hi, 0.00449903, 1e-8);
  EXPECT_EQ(statistics::RateInterval(850, 850).hi, 1.0);
  EXPECT_NEAR(statistics::RateInterval(850, 850).lo, 1 - 0.00449903, 1e-8);
}

// Sleep gained by ten patients, Student's own data (Biometrika 6, 1908, column "2"): 2.33 +- 1.432.
// With two degrees of freedom the two-sided p of t is 1 - t / sqrt(t^2 + 2).
TEST(MeanPTest, IsStudents) {
  EXPECT_NEAR(statistics::StudentP(-2, 2), 1 - 2 / std::sqrt(6.0), 1e-12);
  EXPECT_NEAR(statistics::MeanP(Sample{1, 2, 3}), 1 - std::sqrt(12.0 / 14.0), 1e-12);
  EXPECT_NEAR(statistics::MeanP(Sample{-1, 0, 1}), 1, 1e-12);
  // What 95 % intervals leave out has a p below 5 %.
  const Sample edge = {0.0, 1.0, 2.0, 3.0, 4.0};
  for (const double shift : {-0.04, -0.03}) {
    Sample moved = edge;
    for (double& x : moved) x += shift;
    EXPECT_EQ(statistics::MeanInterval(moved).lo > 0, statistics::MeanP(moved) < 0.05) << shift;
  }
}

TEST(MeanPTest, ASampleWithoutSpreadHasASignOnly) {
  EXPECT_EQ(statistics::MeanP(Sample{3, 3, 3}), 0.25);
  EXPECT_EQ(statistics::MeanP(Sample{0, 0}), 1);
  EXPECT_TRUE(std::isnan(statistics::MeanP(Sample{3})));
}

TEST(MeanIntervalTest, IsStudents) {
  const Sample sleep = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
  ExpectInterval(statistics::MeanInterval(sleep), 0.8976775, 3.7623225, 1e-6);
}

TEST(MeanIntervalTest, ASampleWithoutSpreadHasAPoint) {
  ExpectInterval(statistics::MeanInterval(Sample{4, 4, 4}), 4, 4, 0);
}

// Residuals -1, 2, -1 around the ratio 2: variance 3/2 * 6 / 36, and t with two degrees of freedom.
TEST(RatioIntervalTest, LinearisesTheVariance) {
  const Sample part = {1, 6, 5}, whole = {1, 2, 3};
  const double half = 4.30265273 * 0.5;
  ExpectInterval(statistics::RatioInterval(part, whole), 2 - half, 2 + half, 1e-7);
}

// Student's t with one degree of freedom is 12.7062047 at 97.5 %; Wilson's interval of 0.5 in one trial with it is
// (1 +- t / sqrt(1 + t^2)) / 2.
TEST(IntervalTest, TwoAreEnough) {
  ExpectInterval(statistics::MeanInterval(Sample{1, 3}), 2 - 12.7062047, 2 + 12.7062047, 1e-6);
  ExpectInterval(statistics::RatioInterval(Sample{1, 3}, Sample{1, 1}), 2 - 12.7062047, 2 + 12.7062047, 1e-6);
  ExpectInterval(statistics::RateInterval(1, 2), 0.0945312, 0.9054688, 1e-6);
  const double half = 0.5 * 12.7062047 / std::sqrt(1 + 12.7062047 * 12.7062047);
  ExpectInterval(statistics::ShareInterval(Sample{0, 1}, Sample{1, 1}, statistics::ShareUnit::kMission),
                 0.5 - half, 0.5 + half, 1e-7);
}

TEST(RatioIntervalTest, EqualWholesGiveTheMean) {
  const Sample part = {3, 1, 4, 1, 5}, whole(5, 1.0);
  const statistics::Interval mean = statistics::MeanInterval(part),
                             ratio = statistics::RatioInterval(part, whole);
  ExpectInterval(ratio, mean.lo, mean.hi, 1e-12);
}

TEST(RatioIntervalTest, EmptyWholesDoNotCount) {
  const Sample part = {1, 6, 5}, whole = {1, 2, 3};
  const statistics::Interval without = statistics::RatioInterval(part, whole);
  const statistics::Interval with = statistics::RatioInterval(Sample{0, 1, 6, 0, 5}, Sample{0, 1, 2, 0, 3});
  ExpectInterval(with, without.lo, without.hi, 0);
  EXPECT_FALSE(statistics::RatioInterval(Sample{0, 1}, Sample{0, 1}).Exists());
}

// One timestep per mission: the share is a rate, but for the degrees of freedom (t for z, and n - 1).
TEST(ShareIntervalTest, OfSingleTimestepsIsNearlyTheRate) {
  Sample part(850, 0.0), whole(850, 1.0);
  std::fill_n(part.begin(), 120, 1.0);
  const statistics::Interval rate = statistics::RateInterval(120, 850);
  ExpectInterval(statistics::ShareInterval(part, whole, statistics::ShareUnit::kTimestep), rate.lo, rate.hi,
                 1e-4);
}

// Ten timesteps that always agree are worth one.
TEST(ShareIntervalTest, RepeatedTimestepsAddNothing) {
  Sample part(100, 0.0), once(100, 1.0), part_of_ten(100, 0.0), ten(100, 10.0);
  std::fill_n(part.begin(), 30, 1.0);
  std::fill_n(part_of_ten.begin(), 30, 10.0);
  const statistics::Interval single = statistics::ShareInterval(part, once, statistics::ShareUnit::kMission);
  const statistics::Interval repeated =
      statistics::ShareInterval(part_of_ten, ten, statistics::ShareUnit::kMission);
  ExpectInterval(repeated, single.lo, single.hi, 1e-12);
}

// Two missions that happen to agree at one half show no spread between missions; the six timesteps still do.
TEST(ShareIntervalTest, IsNeverNarrowerThanIndependentTimesteps) {
  const statistics::Interval interval =
      statistics::ShareInterval(Sample{1, 2}, Sample{2, 4}, statistics::ShareUnit::kTimestep);
  const double q2 = 12.7062047 * 12.7062047;
  const double half = std::sqrt(q2) / (1 + q2 / 6) * std::sqrt(0.25 / 6 + q2 / (4 * 36));
  ExpectInterval(interval, 0.5 - half, 0.5 + half, 1e-7);
}

TEST(ShareIntervalTest, NothingAndEverythingHaveAWidth) {
  const Sample whole = {10, 20, 30, 40}, nothing(4, 0.0);
  const double kish = 100.0 * 100 / 3000, q2 = 3.18244631 * 3.18244631;
  const statistics::Interval none =
      statistics::ShareInterval(nothing, whole, statistics::ShareUnit::kMission);
  EXPECT_EQ(none.lo, 0.0);
  EXPECT_NEAR(none.hi, q2 / (kish + q2), 1e-7);
  const statistics::Interval all = statistics::ShareInterval(whole, whole, statistics::ShareUnit::kMission);
  EXPECT_EQ(all.hi, 1.0);
  EXPECT_NEAR(all.lo, 1 - none.hi, 1e-12);
}

TEST(QuantileTest, RankIsTheSmallestThatHoldsTheShare) {
  EXPECT_EQ(statistics::QuantileRank(850, 85), 723);  // its mission opens the group of the 128 longest (R30)
  EXPECT_EQ(statistics::QuantileRank(100, 85), 85);
  EXPECT_EQ(statistics::QuantileRank(20, 85), 17);
  EXPECT_EQ(statistics::QuantileRank(1, 85), 1);
  EXPECT_THROW(statistics::QuantileRank(0, 85), InternalError);
}

// Ranks from the binomial distribution; 2 and 9 of 10 for the median are in every textbook.
TEST(QuantileTest, IntervalIsTwoOrderStatistics) {
  const auto ranks = [](int n, int percent) {
    Sample sorted(n);
    std::iota(sorted.begin(), sorted.end(), 1.0);
    return statistics::QuantileInterval(sorted, percent);
  };
  ExpectInterval(ranks(10, 50), 2, 9, 0);
  ExpectInterval(ranks(850, 85), 702, 744, 0);
  ExpectInterval(ranks(100, 85), 78, 93, 0);
  ExpectInterval(ranks(23, 85), 16, 23, 0);
  EXPECT_FALSE(ranks(22, 85).Exists());
  EXPECT_FALSE(ranks(22, 15).Exists());
}

TEST(IntervalTest, FewerThanTwoMissionsGiveNone) {
  for (const std::size_t n : {0, 1}) {
    const Sample one(n, 1.0);
    EXPECT_FALSE(statistics::MeanInterval(one).Exists());
    EXPECT_FALSE(statistics::RateInterval(0, static_cast<std::int64_t>(n)).Exists());
    EXPECT_FALSE(statistics::RatioInterval(one, one).Exists());
    EXPECT_FALSE(statistics::ShareInterval(one, one, statistics::ShareUnit::kTimestep).Exists());
    EXPECT_FALSE(statistics::QuantileInterval(one, 85).Exists());
  }
}

TEST(IntervalTest, ImpossibleSamplesAreRefused) {
  EXPECT_THROW(statistics::RateInterval(3, 2), InternalError);
  EXPECT_THROW(statistics::RateInterval(-1, 2), InternalError);
  EXPECT_THROW(statistics::RatioInterval(Sample{1}, Sample{1, 2}), InternalError);
  EXPECT_THROW(statistics::RatioInterval(Sample{1, 1}, Sample{1, -2}), InternalError);
  EXPECT_THROW(statistics::ShareInterval(Sample{3, 1}, Sample{2, 2}, statistics::ShareUnit::kTimestep),
               InternalError);
  EXPECT_THROW(statistics::QuantileInterval(Sample{2, 1}, 85), InternalError);
}

}  // namespace
}  // namespace ed3r
