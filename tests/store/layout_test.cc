#include "engine/store/layout.h"

#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

TEST(LayoutTest, NumbersMissionsInPlanOrder) {
  const RunLayout layout = TestLayout();
  EXPECT_EQ(layout.Missions(), 100);
  std::int64_t index = 0;
  for (const sweep::RunId& id : AllMissions(layout)) EXPECT_EQ(layout.LinearIndex(id), index++);
  EXPECT_EQ(index, 100);
  EXPECT_EQ(layout.RunIndex(sweep::RunId{2, 1, 0}), 3);
  EXPECT_EQ(layout.Scenario({2, 1, 4}), 5004);
  EXPECT_THROW(layout.LinearIndex({1, 0, 0}), InternalError);
  EXPECT_THROW(layout.RunIndex(sweep::RunId{2, 1, 30}), InternalError);
  EXPECT_THROW(layout.RunIndex(0, 1), InternalError) << "not the first arm of the next stage";
  EXPECT_THROW(layout.RunIndex(3, 0), InternalError);
}

TEST(LayoutTest, IsTakenFromThePlan) {
  sweep::SweepPlan plan;
  plan.name = "sweep";
  plan.seed = 99;
  sweep::Arm arm;
  arm.name = "rbs";
  arm.config.mission.first_scenario = 17;
  plan.stages = {{.name = "online",
                  .kind = sweep::StageKind::kFly,
                  .after = {},
                  .missions = 5,
                  .precision = {},
                  .arms = {arm}},
                 {.name = "train",
                  .kind = sweep::StageKind::kTrain,
                  .after = {},
                  .missions = 0,
                  .precision = {},
                  .arms = {}}};
  const RunLayout layout = LayoutOf(plan);
  EXPECT_EQ(layout.name, "sweep");
  EXPECT_EQ(layout.seed, 99u);
  ASSERT_EQ(layout.stages.size(), 2u);
  EXPECT_EQ(layout.Missions(), 5);
  EXPECT_EQ(layout.Describe({0, 0, 4}), "stage online, arm rbs, mission 4");
  EXPECT_EQ(layout.Scenario({0, 0, 4}), 21);
}

}  // namespace
}  // namespace ed3r::store
