// Training rows say what the agents saw when they decided.
#include "engine/mission/samples.h"

#include <gtest/gtest.h>

#include "engine/agents/reward.h"
#include "engine/mission/mission.h"
#include "engine/rfnn/features.h"
#include "tests/mission/small_world.h"

namespace ed3r::mission {
namespace {

TEST(SamplesTest, RowsFollowTheRecord) {
  const world::Scene scene(FlatParts());
  Config config;
  config.mission.strategy = "random";
  MissionTask task{.scene = scene, .config = config};
  task.seed = 5;
  task.scenario = 1;
  const MissionRecord record = FlyMission(task);
  AgentsConfig stricter = config.agents;
  stricter.eta_min = 0.85;
  rfnn::DataSet rc(rfnn::kRcNetwork.inputs()), robot(rfnn::kRobotNetwork.inputs());
  AppendSamples(record, 17, config, stricter, rc, robot);
  ASSERT_EQ(rc.rows(), record.steps.size());
  ASSERT_EQ(robot.rows(), record.steps.size());

  const auto f = [](double value) { return static_cast<float>(value); };
  EXPECT_EQ(rc.row(0)[rfnn::kRcX], f(record.start_x_m));
  EXPECT_EQ(rc.row(0)[rfnn::kRcPreviousScs], 0.0F);
  EXPECT_EQ(rc.row(0)[rfnn::kRcDistance], f(record.start_rc_distance_m));
  for (std::size_t k = 1; k < record.steps.size(); ++k) {
    const TimestepRecord& before = record.steps[k - 1];
    const TimestepRecord& step = record.steps[k];
    EXPECT_EQ(rc.row(k)[rfnn::kRcX], f(before.x_m));
    EXPECT_EQ(rc.row(k)[rfnn::kRcTilt], f(before.tilt_rad));
    EXPECT_EQ(rc.row(k)[rfnn::kRcPreviousEnergy], f(before.total_j));
    EXPECT_EQ(rc.row(k)[rfnn::kRcMoveZ], f(step.command_dz_m));
    EXPECT_EQ(robot.row(k)[rfnn::kRobotBattery], f(before.battery_j / 139860.0));
    EXPECT_EQ(robot.row(k)[rfnn::kRobotRate], f(step.rate_bps));
    EXPECT_EQ(robot.row(k)[rfnn::kRobotOffload], step.execution == 0 ? 1.0F : 0.0F);
    EXPECT_EQ(robot.row(k)[rfnn::kRobotQuantized], step.execution == 2 ? 1.0F : 0.0F);
    EXPECT_EQ(rc.targets[k], f(agents::Reward(stricter, step.total_j, step.scs, before.battery_j)));
    EXPECT_EQ(rc.targets[k], robot.targets[k]);
    EXPECT_EQ(rc.missions[k], 17);
  }
}

}  // namespace
}  // namespace ed3r::mission
