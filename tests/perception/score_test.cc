#include "engine/perception/score.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace ed3r::perception {
namespace {

TEST(ScoreTest, MeanMinusPopulationDeviation) {
  const std::array confidences = {0.9, 0.7};
  const Score score = StableConfidence(confidences, 0.5);
  EXPECT_DOUBLE_EQ(score.mean, 0.8);
  EXPECT_NEAR(score.standard_deviation, 0.1, 1e-15);
  EXPECT_NEAR(score.scs, 0.7, 1e-15);
}

TEST(ScoreTest, ZeroMeanIsZeroNotNan) {
  const std::array confidences = {0.0, 0.0, 0.0};
  EXPECT_EQ(StableConfidence(confidences, 0.5).scs, 0.0);
  EXPECT_EQ(StableConfidence({}, 0.5).scs, 0.0);
}

TEST(ScoreTest, FlickerBelowTheThresholdCountsAsNothingSeen) {
  const std::array weak = {0.49, 0.3, 0.49};
  EXPECT_EQ(StableConfidence(weak, 0.5).mean, 0.0);
  EXPECT_GT(StableConfidence(weak, 0.0).mean, 0.4);
}

TEST(ScoreTest, AConfidenceAtTheThresholdCounts) {
  const std::array confidences = {0.5, 0.5, 0.25};
  EXPECT_DOUBLE_EQ(StableConfidence(confidences, 0.5).mean, 1.0 / 3.0);
}

// One confident frame of 33 has a deviation above its mean: the score is cut at 0.
TEST(ScoreTest, InstabilityIsNeverNegative) {
  std::array<double, 33> confidences{};
  confidences[7] = 1.0;
  EXPECT_EQ(StableConfidence(confidences, 0.5).scs, 0.0);
}

}  // namespace
}  // namespace ed3r::perception
