#include "engine/agents/early_completion.h"

#include <gtest/gtest.h>

#include <numbers>

namespace ed3r::agents {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

void ExpectRanges(const CompletionOrder& order, double axis_m, double yaw_deg, double tilt_deg) {
  EXPECT_NEAR(order.ranges.axis_m, axis_m, 1e-12);
  EXPECT_NEAR(order.ranges.yaw_rad, yaw_deg * kDegree, 1e-12);
  EXPECT_NEAR(order.ranges.tilt_rad, tilt_deg * kDegree, 1e-12);
}

// Two consecutive reliable scores complete; the second is taken from a hover (lines 3-5).
TEST(EarlyCompletionTest, TwoReliableTimestepsComplete) {
  EarlyCompletion completion{AgentsConfig()};
  EXPECT_FALSE(completion.Next(0.0).hover);  // k = 1: nothing seen yet
  const CompletionOrder first = completion.Next(0.75);
  EXPECT_TRUE(first.hover);
  EXPECT_FALSE(first.complete);
  EXPECT_EQ(first.band, ConfidenceBand::kReliable);
  EXPECT_EQ(first.epsilon, 0.0);
  EXPECT_TRUE(completion.Next(0.99).complete);
}

TEST(EarlyCompletionTest, AnUnreliableTimestepStartsTheCountAgain) {
  EarlyCompletion completion{AgentsConfig()};
  completion.Next(0.8);
  EXPECT_FALSE(completion.Next(0.7499).complete);
  EXPECT_FALSE(completion.Next(0.8).complete);
  EXPECT_TRUE(completion.Next(0.8).complete);

  EarlyCompletion lost{AgentsConfig()};
  lost.Next(0.8);
  lost.Next(0.0);
  EXPECT_FALSE(lost.Next(0.8).complete);
}

// Lines 6-12: the first intermediate timestep shrinks, later ones widen and explore.
TEST(EarlyCompletionTest, IntermediateShrinksThenWidens) {
  EarlyCompletion completion{AgentsConfig()};
  const CompletionOrder first = completion.Next(0.2);
  EXPECT_EQ(first.band, ConfidenceBand::kIntermediate);
  EXPECT_EQ(first.epsilon, 0.0);
  ExpectRanges(first, 20.0 / 3, 9, 9);
  const CompletionOrder second = completion.Next(0.5);
  EXPECT_EQ(second.band, ConfidenceBand::kPersisting);
  EXPECT_EQ(second.epsilon, 1.0);
  ExpectRanges(second, 20.0 / 3 + 3, 19, 19);
  for (int i = 0; i < 20; ++i) completion.Next(0.5);
  ExpectRanges(completion.Next(0.5), 20, 90, 90);
}

// Line 14.
TEST(EarlyCompletionTest, LowConfidenceResets) {
  EarlyCompletion completion{AgentsConfig()};
  completion.Next(0.5);
  const CompletionOrder low = completion.Next(0.1999);
  EXPECT_EQ(low.band, ConfidenceBand::kLow);
  EXPECT_FALSE(low.epsilon.has_value());  // normal operation decides (R20)
  ExpectRanges(low, 20, 90, 90);
  EXPECT_EQ(completion.Next(0.3).band, ConfidenceBand::kIntermediate);  // c_low started again
}

TEST(EarlyCompletionTest, ElseBranchCanForceZero) {
  AgentsConfig agents;
  agents.else_branch = ElseBranch::kZero;
  EXPECT_EQ(EarlyCompletion(agents).Next(0.0).epsilon, 0.0);
}

// The reliable branch does not reset the ranges, but a new approach shrinks from the full size.
TEST(EarlyCompletionTest, ShrinkingDoesNotCompound) {
  EarlyCompletion completion{AgentsConfig()};
  completion.Next(0.5);
  completion.Next(0.8);
  ExpectRanges(completion.Next(0.5), 20.0 / 3, 9, 9);
}

TEST(EarlyCompletionTest, PatienceIsAKey) {
  AgentsConfig agents;
  agents.completion_patience = 3;
  EarlyCompletion completion{agents};
  EXPECT_FALSE(completion.Next(0.9).complete);
  EXPECT_FALSE(completion.Next(0.9).complete);
  EXPECT_TRUE(completion.Next(0.9).complete);
}

}  // namespace
}  // namespace ed3r::agents
