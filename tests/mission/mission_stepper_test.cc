// Missions whose decisions come from outside.
#include "engine/mission/mission_stepper.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"
#include "tests/mission/small_world.h"

namespace ed3r::mission {
namespace {

class MissionStepperTest : public ::testing::Test {
 protected:
  MissionTask Task(const Config& config, std::uint32_t scenario) const {
    MissionTask task{.scene = scene_, .config = config};
    task.seed = 5;
    task.scenario = scenario;
    return task;
  }
  static Config Flown(const std::string& strategy) {
    Config config;
    config.mission.strategy = strategy;
    return config;
  }

  world::Scene scene_{FlatParts()};
};

robot::MotionCommand CommandOf(const TimestepRecord& step) {
  return {.displacement_m = {step.command_dx_m, step.command_dy_m, step.command_dz_m},
          .turn_rad = step.command_turn_rad,
          .tilt_rad = step.command_tilt_rad};
}

// The decisions of RBS, taken from outside, are the mission of RBS, bit for bit.
TEST_F(MissionStepperTest, TheSameDecisionsAreTheSameMission) {
  const Config rbs = Flown("rbs"), outside = Flown("external");
  int completed = 0;
  for (std::uint32_t scenario = 0; scenario < 6; ++scenario) {
    const MissionRecord flown = FlyMission(Task(rbs, scenario));
    const MissionTask task = Task(outside, scenario);
    MissionStepper mission(task);
    for (const TimestepRecord& step : flown.steps) {
      ASSERT_FALSE(mission.Ended());
      EXPECT_EQ(mission.Order().hover,
                step.motion_rule == static_cast<std::int64_t>(agents::MotionRule::kHover));
      mission.Move(CommandOf(step));
      EXPECT_EQ(mission.RobotSees().rate_bps, step.rate_bps);
      mission.Detect(static_cast<agents::Execution>(step.execution));
      EXPECT_EQ(mission.LastStep().x_m, step.x_m);
      EXPECT_EQ(mission.LastStep().scs, step.scs);
      EXPECT_EQ(mission.LastStep().total_j, step.total_j);
      EXPECT_EQ(mission.LastStep().reward, step.reward);
    }
    if (flown.outcome == static_cast<std::int64_t>(Outcome::kBatteryDepleted)) continue;
    ++completed;
    ASSERT_TRUE(mission.Ended());
    const MissionRecord record = mission.Record();
    EXPECT_EQ(record.outcome, flown.outcome);
    EXPECT_EQ(record.total_j, flown.total_j);
    EXPECT_EQ(record.duration_s, flown.duration_s);
    EXPECT_EQ(record.distance_m, flown.distance_m);
    EXPECT_EQ(record.reward_sum, flown.reward_sum);
  }
  EXPECT_GE(completed, 2);
}

TEST_F(MissionStepperTest, ItEndsWhenTheBatteryCannotPay) {
  Config config = Flown("external");
  config.robot.battery_mah = 300;
  const MissionTask task = Task(config, 1);
  MissionStepper mission(task);
  double last_j = 0.0;
  while (!mission.Ended()) {
    mission.Move({.displacement_m = {0, 0, 1}, .tilt_rad = 1.5});
    mission.Detect(agents::Execution::kQuantized);
    last_j = mission.LastStep().total_j;
  }
  EXPECT_EQ(mission.Result(), Outcome::kBatteryDepleted);
  const MissionRecord record = mission.Record();
  EXPECT_LT(record.battery_left_j, last_j);  // the timestep that it could not pay
  EXPECT_EQ(record.random_motions, 0);
  ASSERT_FALSE(record.steps.empty());
  EXPECT_EQ(record.steps[0].motion_rule, static_cast<std::int64_t>(agents::MotionRule::kOutside));
}

TEST_F(MissionStepperTest, StagesTakeTurns) {
  const Config config = Flown("external");
  const MissionTask task = Task(config, 0);
  MissionStepper mission(task);
  EXPECT_THROW(mission.Detect(agents::Execution::kFull), InternalError);
  EXPECT_THROW(mission.Record(), InternalError);
  EXPECT_THROW(mission.Move({.turn_rad = NAN}), UserError);
  mission.Move({});
  EXPECT_THROW(mission.Move({}), InternalError);
  mission.Detect(agents::Execution::kFull);
  EXPECT_EQ(mission.Timestep(), 2u);
}

TEST_F(MissionStepperTest, ALimitCutsItShort) {
  Config config = Flown("external");
  config.mission.max_timesteps = 2;
  const MissionTask task = Task(config, 0);
  MissionStepper mission(task);
  for (int k = 0; k < 2; ++k) {
    EXPECT_FALSE(mission.AtLimit());
    mission.Move({.tilt_rad = 1.5});
    mission.Detect(agents::Execution::kQuantized);
  }
  EXPECT_TRUE(mission.AtLimit());
}

TEST_F(MissionStepperTest, AStrategyThatDecidesItselfIsNotStepped) {
  const Config config = Flown("rbs");
  const MissionTask task = Task(config, 0);
  EXPECT_THROW(MissionStepper{task}, InternalError);
}

}  // namespace
}  // namespace ed3r::mission
