#include "engine/perception/render/training_views.h"

#include <gtest/gtest.h>

#include <vector>

#include "engine/perception/view.h"
#include "tests/perception/render/small_view.h"

namespace ed3r::perception {
namespace {

TEST(DataSet, HalfOfTheViewsShowFireAndAllArePosesOfARobot) {
  const auto hill = [](double x_m, double y_m) {
    return 30.0 * std::exp(-((x_m - 200) * (x_m - 200) + (y_m - 200) * (y_m - 200)) / 5000.0);
  };
  const auto scene = FireScene(hill, {270, 230});
  const std::vector<std::shared_ptr<const TraceScene>> scenes = {std::make_shared<TraceScene>(*scene)};
  Config config;
  const FireView fire(*scene, 0);
  int with_fire = 0;
  for (std::uint32_t number = 0; number < 100; ++number) {
    const ViewPlan plan = PlanView(scenes, config, 9, number);
    const ViewPlan again = PlanView(scenes, config, 9, number);
    EXPECT_EQ(plan.pose.position_m, again.pose.position_m);
    EXPECT_EQ(plan.pose.yaw_rad, again.pose.yaw_rad);
    const Eigen::Vector3d& at_m = plan.pose.position_m;
    EXPECT_GE(at_m.z() - scene->Ground().HeightAt(at_m.x(), at_m.y()), 3.0 - 1e-9);
    EXPECT_GE(plan.pose.tilt_rad, 0.0);
    EXPECT_LE(plan.pose.tilt_rad, 0.5 * kPi + 1e-9);
    with_fire += fire.Look(plan.pose, config.sensing, config.perception, {}).fire_in_view;
  }
  EXPECT_GE(with_fire, 45);
  EXPECT_LE(with_fire, 55);
}

TEST(DataSet, NamesTheDistractorsInTheFrame) {
  const auto scene = FireScene([](double, double) { return 0.0; }, {380, 380});
  const auto traced = std::make_shared<TraceScene>(*scene);
  PerceptionConfig perception;
  perception.distractors_per_km2 = 2000.0;
  const Renderer many(traced, 0, perception, SensingConfig(), 1, 1);
  const robot::Pose pose = LookFrom(100, 200, 60, 0, 40);
  EXPECT_EQ(PropsInView(many, *scene, pose, SensingConfig()), "roof;vehicle;rock;autumn;fog");
  perception.distractors_per_km2 = 0.0;
  const Renderer none(traced, 0, perception, SensingConfig(), 1, 1);
  EXPECT_EQ(PropsInView(none, *scene, pose, SensingConfig()), "");
}

}  // namespace
}  // namespace ed3r::perception
