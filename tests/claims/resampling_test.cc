#include "studies/statistics/resampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "engine/core/check.h"

namespace ed3r::claims {
namespace {

TEST(ResamplerTest, MissionsStayWithinTheirNetworks) {
  const statistics::Resampler resampler({0, 1, 1, 0, 2, 1}, 3);
  std::vector<int> counts;
  std::vector<int> seen(6, 0);
  for (int b = 0; b < 200; ++b) {
    resampler.DrawMissions(b, counts);
    ASSERT_EQ(counts.size(), 6u);
    EXPECT_EQ(counts[0] + counts[3], 2);
    EXPECT_EQ(counts[1] + counts[2] + counts[5], 3);
    EXPECT_EQ(counts[4], 1);
    for (std::size_t i = 0; i < 6; ++i) seen[i] += counts[i];
  }
  for (const int count : seen)
    EXPECT_NEAR(count, 200, 45);  // three standard deviations of 200 draws in three
}

TEST(ResamplerTest, NetworksAreDrawnWithReplacement) {
  const statistics::Resampler resampler({0, 1, 2, 3, 4}, 5);
  std::vector<int> counts;
  int repeated = 0;
  for (int b = 0; b < 200; ++b) {
    resampler.DrawNetworks(b, counts);
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0), 5);
    for (const int count : counts) repeated += count > 1 ? 1 : 0;
  }
  EXPECT_GT(repeated, 100);
}

TEST(ResamplerTest, SameNumberSameDraws) {
  const statistics::Resampler one({0, 0, 0, 1, 1, 1, 1}, 2), two({0, 0, 0, 1, 1, 1, 1}, 2);
  std::vector<int> a, b, c;
  one.DrawMissions(7, a), two.DrawMissions(8, b), two.DrawMissions(7, c);
  EXPECT_EQ(a, c);
  EXPECT_NE(a, b);
}

TEST(ResamplerTest, UnitsBelongToAGroup) {
  EXPECT_THROW(statistics::Resampler({0, 2}, 2), InternalError);
  EXPECT_THROW(statistics::Resampler({-1}, 2), InternalError);
}

// 0, 1, ..., 1000 around its middle.
std::vector<double> Ramp(double width) {
  std::vector<double> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(10 + width * (i / 1000.0 - 0.5));
  return values;
}

TEST(UncertaintyTest, OverMissionsItIsThePercentiles) {
  const statistics::Resampled number{10, Ramp(4), {}, 1};
  const statistics::Uncertainty u = statistics::UncertaintyOf(number);
  EXPECT_NEAR(u.lo, 8.1, 1e-9);
  EXPECT_NEAR(u.hi, 11.9, 1e-9);
  EXPECT_NEAR(u.sd_missions, 4 / std::sqrt(12.0), 0.01);
  EXPECT_TRUE(std::isnan(u.sd_networks));
}

// Three networks: sd of the resamples 1 (two points, half each), x sqrt(3/2), x t of 2 degrees 4.303.
TEST(UncertaintyTest, OverNetworksItIsStudents) {
  std::vector<double> networks;
  for (int i = 0; i < 5000; ++i) networks.push_back(i % 2 == 0 ? 9 : 11);
  const statistics::Uncertainty u = statistics::UncertaintyOf({10, Ramp(0.4), networks, 3});
  EXPECT_NEAR(u.sd_networks, std::sqrt(1.5), 1e-3);
  EXPECT_NEAR(u.hi - 10, 4.30265 * std::sqrt(1.5), 1e-3);
  EXPECT_NEAR(10 - u.lo, 4.30265 * std::sqrt(1.5), 1e-3);
}

// Missions: squares 2.25 + 0.25 + 0.25 + 2.25 over 3; the ends of four are the percentiles. Networks: sd sqrt(2) of 9 and 11,
// x sqrt(2/1), x t of 1 degree 12.706.
TEST(UncertaintyTest, OfFewResamplesByHand) {
  const statistics::Uncertainty u = statistics::UncertaintyOf({2.5, {4, 1, 3, 2}, {}, 1});
  EXPECT_NEAR(u.sd_missions, std::sqrt(5.0 / 3.0), 1e-12);
  EXPECT_EQ(u.lo, 1);
  EXPECT_EQ(u.hi, 4);
  const statistics::Uncertainty two = statistics::UncertaintyOf({2.5, {4, 1, 3, 2}, {9, 11}, 2});
  EXPECT_NEAR(two.sd_networks, 2, 1e-12);
  EXPECT_NEAR(two.lo, 2.5 - 25.4124095, 1e-6);
  EXPECT_NEAR(two.hi, 2.5 + 25.4124095, 1e-6);
  EXPECT_TRUE(std::isnan(statistics::UncertaintyOf({2.5, {4, 1, 3, 2}, {9, 11}, 1}).sd_networks));
}

// Four missions of one network: the spread is by n - 1, and t of 3 degrees reaches 3.182 where the normal does 1.960.
TEST(UncertaintyTest, FewMissionsAreKnownLessWell) {
  const statistics::Resampled many{10, Ramp(4), {}, 1};
  statistics::Resampled four = many;
  four.units = 4;
  const statistics::Uncertainty wide = statistics::UncertaintyOf(four), u = statistics::UncertaintyOf(many);
  EXPECT_NEAR(wide.sd_missions, u.sd_missions * std::sqrt(4.0 / 3.0), 1e-12);
  EXPECT_NEAR(wide.hi - 10, 1.9 * std::sqrt(4.0 / 3.0) * 3.182446 / 1.959964, 1e-5);
  EXPECT_NEAR(10 - wide.lo, wide.hi - 10, 1e-9);
  EXPECT_NEAR(statistics::TestAgainst(four, wide, 10 - 3.182446 * wide.sd_missions).above, 0.05, 1e-6);
  // 40 missions of 20 networks are known by 20 degrees.
  statistics::Resampled twenty = many;
  twenty.units = 40, twenty.strata = 20;
  EXPECT_NEAR(statistics::UncertaintyOf(twenty).sd_missions, u.sd_missions * std::sqrt(2.0), 1e-12);
}

TEST(UncertaintyTest, OneMissionTellsNothing) {
  statistics::Resampled one{-100, std::vector<double>(2000, -100.0), {}, 1};
  one.units = 1;
  const statistics::Uncertainty u = statistics::UncertaintyOf(one);
  EXPECT_TRUE(std::isnan(u.lo) && std::isnan(u.hi) && std::isnan(u.sd_missions));
  EXPECT_EQ(statistics::TestAgainst(one, u, 0).below, 1);
  EXPECT_EQ(statistics::TestAgainst(one, u, 0).above, 1);
  // Two tell, by one degree of freedom.
  statistics::Resampled two{10, Ramp(4), {}, 1};
  two.units = 2;
  EXPECT_NEAR(statistics::UncertaintyOf(two).hi - 10, 1.9 * std::sqrt(2.0) * 12.7062047 / 1.959964, 1e-4);
}

TEST(UncertaintyTest, HalfOfTheResamplesAreEnoughAndOneIsNot) {
  const double none = std::nan("");
  EXPECT_NEAR(statistics::UncertaintyOf({1, {1, none, 2, none}, {}, 1}).sd_missions, std::sqrt(0.5), 1e-12);
  EXPECT_TRUE(std::isnan(statistics::UncertaintyOf({1, {1, none, 2, none, none}, {}, 1}).sd_missions));
  EXPECT_TRUE(std::isnan(statistics::UncertaintyOf({1, {1, none}, {}, 1}).sd_missions));
}

TEST(UncertaintyTest, NetworksThatAgreeByAccidentNarrowNothing) {
  const statistics::Uncertainty u =
      statistics::UncertaintyOf({10, Ramp(4), std::vector<double>(1000, 10.0), 5});
  EXPECT_NEAR(u.lo, 8.1, 1e-9);
  EXPECT_NEAR(u.hi, 11.9, 1e-9);
}

TEST(UncertaintyTest, MissingResamplesGiveNone) {
  std::vector<double> most_missing(1000, std::nan(""));
  for (int i = 0; i < 400; ++i) most_missing[static_cast<std::size_t>(i)] = i;
  EXPECT_TRUE(std::isnan(statistics::UncertaintyOf({10, most_missing, {}, 1}).lo));
  EXPECT_TRUE(std::isnan(statistics::UncertaintyOf({10, {}, {}, 1}).hi));
  EXPECT_TRUE(std::isnan(statistics::UncertaintyOf({std::nan(""), Ramp(1), {}, 1}).lo));
  const statistics::Resampled nothing{10, {}, {}, 1};
  const statistics::Sides sides = statistics::TestAgainst(nothing, statistics::UncertaintyOf(nothing), 0);
  EXPECT_EQ(sides.above, 1);
  EXPECT_EQ(sides.below, 1);
}

TEST(SidesTest, TwiceTheTailOfTheWiderLevel) {
  const statistics::Resampled number{10, Ramp(4), {}, 1};
  const statistics::Uncertainty u = statistics::UncertaintyOf(number);
  // 1.96 standard deviations below the number: 2.5 % twice.
  EXPECT_NEAR(statistics::TestAgainst(number, u, 10 - 1.959964 * u.sd_missions).above, 0.05, 1e-6);
  EXPECT_EQ(statistics::TestAgainst(number, u, 10 - 1.959964 * u.sd_missions).below, 1);
  EXPECT_NEAR(statistics::TestAgainst(number, u, 10 + 1.959964 * u.sd_missions).below, 0.05, 1e-6);
  EXPECT_EQ(statistics::TestAgainst(number, u, 10).above, 1);
  // Student's t of 4 degrees: 2.776 for 5 %.
  std::vector<double> networks;
  for (int i = 0; i < 5000; ++i) networks.push_back(i % 2 == 0 ? 8 : 12);
  const statistics::Resampled wide{10, Ramp(4), networks, 5};
  const statistics::Uncertainty w = statistics::UncertaintyOf(wide);
  EXPECT_NEAR(statistics::TestAgainst(wide, w, 10 - 2.776445 * w.sd_networks).above, 0.05, 1e-6);
  EXPECT_NEAR(statistics::TestAgainst(wide, w, 10 + 2.776445 * w.sd_networks).below, 0.05, 1e-6);
}

// By construction ("always offloads"): no spread at all.
TEST(SidesTest, WithoutSpreadTheSignDecides) {
  const statistics::Resampled constant{100, std::vector<double>(2000, 100.0), {}, 1};
  const statistics::Uncertainty u = statistics::UncertaintyOf(constant);
  EXPECT_EQ(statistics::TestAgainst(constant, u, 50).above, 0);
  EXPECT_EQ(statistics::TestAgainst(constant, u, 50).below, 1);
  EXPECT_EQ(statistics::TestAgainst(constant, u, 100).above, 1);
  // Five missions that say the same: 2^-5 on this side by chance, twice.
  statistics::Resampled five = constant;
  five.units = 5;
  EXPECT_DOUBLE_EQ(statistics::TestAgainst(five, statistics::UncertaintyOf(five), 50).above, 1.0 / 16);
}

}  // namespace
}  // namespace ed3r::claims
