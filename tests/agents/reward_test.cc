#include "engine/agents/reward.h"

#include <gtest/gtest.h>

namespace ed3r::agents {
namespace {

// By hand: E = 2 kJ of 10 kJ, eta = 0.5 below 0.75: -(0.2 + 2 (0.25 + 0.5)).
TEST(RewardTest, BelowTheThresholdTheMissCountsTwice) {
  EXPECT_DOUBLE_EQ(Reward(AgentsConfig(), 2000, 0.5, 100000), -(0.2 + 2 * (0.25 + 0.5)));
}

TEST(RewardTest, AboveTheThresholdOnlyTheDetectionTermIsLeft) {
  EXPECT_DOUBLE_EQ(Reward(AgentsConfig(), 1000, 0.9, 100000), -(0.1 + 2 * (1.0 - 0.9)));
}

TEST(RewardTest, BeyondTheBatteryIsPenalised) {
  EXPECT_DOUBLE_EQ(Reward(AgentsConfig(), 3000, 1.0, 1000), -(0.3 + 2 * 0.2));
}

TEST(RewardTest, WeightsAreTheirs) {
  AgentsConfig agents;
  agents.mu1 = 3;
  agents.lambda1 = 5;
  agents.lambda2 = 7;
  EXPECT_DOUBLE_EQ(Reward(agents, 1000, 0.5, 1e6), -(3 * 0.1 + 2 * (5 * 0.25 + 7 * 0.5)));
}

}  // namespace
}  // namespace ed3r::agents
