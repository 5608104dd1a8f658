#include "engine/agents/strategy.h"

#include <gtest/gtest.h>

#include <array>

#include "engine/agents/robot_agent.h"
#include "engine/core/check.h"

namespace ed3r::agents {
namespace {

// The paper's Table of ablations, line by line.
TEST(StrategyTest, AblationsRestrictTheRobotOnly) {
  const Strategy& ed3r = FindStrategy("ed3r");
  const auto allowed = [](std::string_view name) {
    const AllowedExecutions& a = FindStrategy(name).execution.allowed;
    return std::vector<bool>{a.offload, a.full, a.quantized};
  };
  EXPECT_EQ(allowed("ed3r"), (std::vector<bool>{true, true, true}));
  EXPECT_EQ(allowed("ablation-1"), (std::vector<bool>{false, true, false}));
  EXPECT_EQ(allowed("ablation-2"), (std::vector<bool>{false, false, true}));
  EXPECT_EQ(allowed("ablation-3"), (std::vector<bool>{false, true, true}));
  EXPECT_EQ(allowed("ablation-4"), (std::vector<bool>{true, false, false}));
  for (std::string_view name : {"ablation-1", "ablation-2", "ablation-3", "ablation-4"}) {
    const Strategy& ablation = FindStrategy(name);
    EXPECT_EQ(ablation.motion, ed3r.motion);
    EXPECT_EQ(ablation.early_completion, ed3r.early_completion);
    EXPECT_EQ(ablation.networks, ed3r.networks);
  }
}

TEST(StrategyTest, UnknownNameIsRefusedWithTheList) {
  try {
    FindStrategy("edr3");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_STREQ(error.what(),
                 "mission.strategy: 'edr3' is not allowed; allowed: random | random-offload | rbs | ed3r | "
                 "ablation-1 | "
                 "ablation-2 | ablation-3 | ablation-4 | ecd2r | look-level | external; did you mean ed3r?");
  }
}

// How often of 3000 a random robot offloads, looks with Full, with Quantized.
std::array<int, 3> RandomChoices(const char* strategy, RandomExecution random) {
  Config config;
  config.agents.random_execution = random;
  std::array<int, 3> counts{};
  for (std::uint32_t scenario = 0; scenario < 3000; ++scenario) {
    RobotAgent robot({.config = config,
                      .strategy = FindStrategy(strategy),
                      .networks = {},
                      .size_m = {530, 530, 165},
                      .seed = 1,
                      .scenario = scenario});
    ++counts[static_cast<std::size_t>(robot.ChooseExecution(RobotView(), 1.0, 1).execution)];
  }
  return counts;
}

TEST(StrategyTest, RandomRobotUsesAllThreeActionsAlike) {
  for (const int count : RandomChoices("random", RandomExecution::kEqual))
    EXPECT_NEAR(count, 1000, 130);  // five standard deviations
}

TEST(StrategyTest, OrTossesACoinForOffloadingFirst) {
  const auto [offload, full, quantized] = RandomChoices("random", RandomExecution::kCoin);
  EXPECT_NEAR(offload, 1500, 137);
  EXPECT_NEAR(full, 750, 119);
  EXPECT_NEAR(quantized, 750, 119);
  EXPECT_EQ(RandomChoices("random-offload", RandomExecution::kCoin)[0], 3000);
}

}  // namespace
}  // namespace ed3r::agents
