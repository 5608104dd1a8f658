#include "engine/robot/lidar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/random.h"
#include "tests/world/scene_builder.h"

namespace ed3r::robot {
namespace {

constexpr double kTubeM = 0.55;
constexpr double kRangeM = 30.0;

world::Tree Trunk(double x_m, double y_m, double radius_m) {
  return {.x_m = x_m,
          .y_m = y_m,
          .ground_m = 0,
          .height_m = 40,
          .trunk_radius_m = radius_m,
          .crown_radius_m = 1,
          .crown_depth_m = 4};
}

world::Scene FlatScene(std::vector<world::Tree> trees) {
  return world::Scene(world::PartsOf(
      21, 10.0, [](double, double) { return 0.0; }, std::move(trees)));
}

TEST(LidarBundleTest, SeesWhatIsInTheTubeOnly) {
  const world::Scene scene = FlatScene({Trunk(110, 100, 0.3)});
  const LidarBundle lidars(scene.Geometry(), kTubeM, kRangeM);
  const Eigen::Vector3d east = Eigen::Vector3d::UnitX();
  // The trunk is a pentagon: its faces are up to a fifth of the radius nearer to the axis.
  EXPECT_NEAR(lidars.FreeDistance({100, 100, 20}, east), 9.7, 0.1);
  EXPECT_TRUE(std::isfinite(lidars.FreeDistance({100, 100.7, 20}, east)));  // the trunk's edge is in the tube
  EXPECT_TRUE(std::isinf(lidars.FreeDistance({100, 100.9, 20}, east)));     // it passes beside
  EXPECT_TRUE(std::isinf(lidars.FreeDistance({75, 100, 20}, east)));        // out of range
  EXPECT_TRUE(std::isinf(lidars.FreeDistance({100, 100, 20}, -east)));
  EXPECT_NEAR(lidars.FreeDistance({100, 100, 20}, -Eigen::Vector3d::UnitZ()), 20.0, 1e-3);
  EXPECT_TRUE(std::isinf(lidars.FreeDistance({100, 100, 20}, Eigen::Vector3d::UnitZ())));
}

TEST(LidarBundleTest, NoThinTrunkSlipsBetweenTheRays) {
  const world::Scene scene = FlatScene({Trunk(100, 100, 0.15)});
  for (const double tube_m : {0.45, kTubeM, 1.5, 2.6}) {
    const LidarBundle lidars(scene.Geometry(), tube_m, kRangeM);
    Stream draw(5, 0, Purpose::kMotion);
    for (int i = 0; i < 300; ++i) {
      const double heading = draw.Uniform(0, 2 * std::numbers::pi);
      const Eigen::Vector3d direction(std::cos(heading), std::sin(heading), 0);
      const Eigen::Vector3d side(-direction.y(), direction.x(), 0);
      // The robot's own width; the tube is wider by the margin.
      const Eigen::Vector3d start = Eigen::Vector3d(100, 100, draw.Uniform(8, 30)) - 12.0 * direction +
                                    draw.Uniform(-1, 1) * (tube_m - 0.1) * side;
      EXPECT_NEAR(lidars.FreeDistance(start, direction), 12.0, 0.2) << tube_m;
    }
  }
}

TEST(LegWatchTest, OneScanDoesForAStraightLegInSight) {
  const world::Scene scene = FlatScene({Trunk(112, 100, 0.3)});
  const LidarBundle lidars(scene.Geometry(), kTubeM, kRangeM);
  LegWatch watch(lidars, {.stand_off_m = 2.0, .drift_m = 0.1}, {100, 100, 20}, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(watch.RestLimitM(), 9.7, 0.1);
  for (double x = 0; x < 9; x += 0.1) watch.Tick({100 + x, 100.05, 20}, x + 2);
  EXPECT_EQ(watch.Scans(), 1);
}

TEST(LegWatchTest, LooksAgainWhenItDriftsOrRunsOutOfSight) {
  const world::Scene scene = FlatScene({Trunk(115, 101, 0.3), Trunk(150, 99, 0.3)});
  const LidarBundle lidars(scene.Geometry(), kTubeM, kRangeM);
  LegWatch watch(lidars, {.stand_off_m = 2.0, .drift_m = 0.1}, {100, 100, 20}, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(watch.RestLimitM(), 28.0, 1e-9);  // the first trunk is beside the tube
  watch.Tick({103, 100.05, 20}, 5);
  EXPECT_EQ(watch.Scans(), 1);
  watch.Tick({104, 100.3, 20}, 6);  // drifted towards it
  EXPECT_EQ(watch.Scans(), 2);
  EXPECT_NEAR(watch.RestLimitM(), 12.7, 0.2);
  watch.Tick({105, 100.0, 20}, 7);  // and back: what was seen is remembered
  EXPECT_EQ(watch.Scans(), 3);
  EXPECT_NEAR(watch.RestLimitM(), 12.7, 0.2);

  LegWatch free(lidars, {.stand_off_m = 2.0, .drift_m = 0.1}, {100, 98.6, 20}, Eigen::Vector3d::UnitX());
  free.Tick({125, 98.6, 20}, 27.9);
  EXPECT_EQ(free.Scans(), 1);
  free.Tick({126, 98.6, 20}, 28.1);  // beyond what was seen
  EXPECT_EQ(free.Scans(), 2);
  EXPECT_NEAR(free.RestLimitM(), 47.7, 0.2);
}

}  // namespace
}  // namespace ed3r::robot
