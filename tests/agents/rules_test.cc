#include <gtest/gtest.h>

#include "engine/agents/strategies/rbs_execution.h"

namespace ed3r::agents {
namespace {

// Share of a decision over many draws for given ratios.
struct Shares {
  double offload = 0, full = 0, quantized = 0;
};
Shares Decide(double rate_ratio, double cpu_ratio, const RbsConfig& rbs = {}) {
  Shares shares;
  RobotView view;
  view.rate_ratio = rate_ratio;
  view.cpu_ratio = cpu_ratio;
  const int n = 4000;
  for (std::uint32_t i = 0; i < n; ++i) {
    Stream stream(1, i, Purpose::kExecution);
    const Execution execution = DecideByRules(rbs, view, stream).execution;
    shares.offload += execution == Execution::kOffload ? 1.0 / n : 0;
    shares.full += execution == Execution::kFull ? 1.0 / n : 0;
    shares.quantized += execution == Execution::kQuantized ? 1.0 / n : 0;
  }
  return shares;
}

TEST(RulesTest, TheRatioAboveItsThresholdDecides) {
  EXPECT_DOUBLE_EQ(Decide(0.9, 0.5).offload, Decide(1.0, 0.1).offload);
  EXPECT_NEAR(Decide(0.9, 0.5).offload, 1.0, 1e-9);
  EXPECT_EQ(Decide(0.2, 0.9).offload, 0.0);
}

TEST(RulesTest, BothAboveIsACoinFlip) {
  const Shares shares = Decide(0.9, 0.9);
  EXPECT_NEAR(shares.offload, 0.5, 0.04);  // five standard errors
  EXPECT_NEAR(shares.full, 0.25, 0.035);
  EXPECT_NEAR(shares.quantized, 0.25, 0.035);
}

TEST(RulesTest, NoneAboveTakesTheNearest) {
  EXPECT_NEAR(Decide(0.80, 0.50).offload, 1.0, 1e-9);  // 0.05 below against 0.15 below
  EXPECT_EQ(Decide(0.60, 0.60).offload, 0.0);
  EXPECT_EQ(Decide(0.85, 0.65).offload,
            0.0);  // exactly at both thresholds: none exceeds, a tie stays on board
}

TEST(RulesTest, ModelIsAKey) {
  EXPECT_NEAR(Decide(0.1, 0.9, {.model = RbsModel::kFull}).full, 1.0, 1e-9);
  EXPECT_NEAR(Decide(0.1, 0.9, {.model = RbsModel::kQuantized}).quantized, 1.0, 1e-9);
}

}  // namespace
}  // namespace ed3r::agents
