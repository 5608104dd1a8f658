#include "engine/agents/action_ranges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ed3r::agents {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(ActionRangesTest, PercentRule) {
  AgentsConfig agents;
  agents.range_rule = RangeRule::kPercent;
  const ActionRanges smaller = ActionRanges::Full(agents).Decreased(agents);
  EXPECT_NEAR(smaller.axis_m, 19.4, 1e-12);
  EXPECT_NEAR(smaller.yaw_rad, 81 * kDegree, 1e-12);
  EXPECT_NEAR(smaller.Increased(agents).axis_m, 19.4 * 1.03, 1e-12);
}

TEST(ActionRangesTest, TiltIntervalIsCentredAndCut) {
  const AgentsConfig agents;
  const ActionRanges full = ActionRanges::Full(agents);
  const TiltInterval all = TiltCommands(full, agents, 10 * kDegree);
  EXPECT_EQ(all.low_rad, 0.0);
  EXPECT_NEAR(all.high_rad, 90 * kDegree, 1e-12);
  const TiltInterval near_level = TiltCommands(full.Decreased(agents), agents, 2 * kDegree);
  EXPECT_EQ(near_level.low_rad, 0.0);
  EXPECT_NEAR(near_level.high_rad, 6.5 * kDegree, 1e-12);
}

TEST(ActionRangesTest, DrawsFillTheRangesAndStayInside) {
  const AgentsConfig agents;
  const ActionRanges ranges = ActionRanges::Full(agents).Decreased(agents);
  Stream stream(1, 2, Purpose::kMotion);
  double largest_m = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const robot::MotionCommand command = DrawCommand(ranges, agents, 45 * kDegree, stream);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LE(std::abs(command.displacement_m[axis]), ranges.axis_m);
      largest_m = std::max(largest_m, std::abs(command.displacement_m[axis]));
    }
    ASSERT_LE(std::abs(command.turn_rad), ranges.yaw_rad);
    ASSERT_GE(command.tilt_rad, 40.5 * kDegree);
    ASSERT_LE(command.tilt_rad, 49.5 * kDegree);
    ASSERT_FALSE(command.hover);
  }
  EXPECT_GT(largest_m, 0.99 * ranges.axis_m);
}

}  // namespace
}  // namespace ed3r::agents
