#include "studies/statistics/holm.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"

namespace ed3r::claims {
namespace {

void ExpectAdjusted(const std::vector<double>& p, const std::vector<double>& expected) {
  const std::vector<double> adjusted = statistics::HolmAdjust(p);
  ASSERT_EQ(adjusted.size(), expected.size());
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(adjusted[i], expected[i], 1e-12) << i;
}

// By hand: 0.005 x 4, 0.01 x 3, then 0.03 x 2; 0.04 x 1 would be less than the one before.
TEST(HolmTest, StepsDown) { ExpectAdjusted({0.01, 0.04, 0.03, 0.005}, {0.03, 0.06, 0.06, 0.02}); }

TEST(HolmTest, TiesAreAdjustedAlike) { ExpectAdjusted({0.02, 0.02, 0.5}, {0.06, 0.06, 0.5}); }

TEST(HolmTest, StopsAtOneAndKeepsASingleOne) {
  ExpectAdjusted({0.6, 0.7, 0}, {1, 1, 0});
  ExpectAdjusted({0.04}, {0.04});
  EXPECT_TRUE(statistics::HolmAdjust({}).empty());
}

TEST(HolmTest, OnlyProbabilities) {
  EXPECT_THROW(statistics::HolmAdjust(std::vector<double>{1.2}), InternalError);
  EXPECT_THROW(statistics::HolmAdjust(std::vector<double>{std::numeric_limits<double>::quiet_NaN()}),
               InternalError);
}

}  // namespace
}  // namespace ed3r::claims
