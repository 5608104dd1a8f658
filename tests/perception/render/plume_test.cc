#include "engine/perception/render/plume.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/perception/view.h"
#include "tests/perception/render/small_view.h"

namespace ed3r::perception {
namespace {

GroundTruth TruthFrom(const world::Scene& scene, const robot::Pose& pose, int site = 0) {
  const Renderer renderer(std::make_shared<TraceScene>(scene), site, ClearView(), SensingConfig(), 1, 1);
  const int first[] = {0};
  return renderer.Sense(pose, 1, first, {}).truth;
}

TEST(Plume, AFireBehindARidgeHasNoVisiblePixels) {
  // A wall across the area, higher than the smoke.
  const auto ridge = [](double x_m, double) {
    return 90.0 * std::max(0.0, 1.0 - std::abs(x_m - 200.0) / 60.0);
  };
  const auto scene = FireScene(ridge, {300, 200});
  const GroundTruth hidden = TruthFrom(*scene, LookFrom(100, 200, 20, 0, 0));
  EXPECT_EQ(hidden.fire_px, 0);
  EXPECT_EQ(hidden.smoke_px, 0);
  EXPECT_FALSE(hidden.FireInView());
  EXPECT_DOUBLE_EQ(hidden.occluded, 1.0);

  const auto flat = FireScene([](double, double) { return 0.0; }, {300, 200});
  const GroundTruth open = TruthFrom(*flat, LookFrom(100, 200, 20, 0, 0));
  // A cone shows radius x height; a pixel covers 3.5 m at 200 m. Turbulence makes the flame somewhat fuller.
  const double pixel_m = 200.0 * 2.0 * std::tan(40.0 * kPi / 180.0) / 96.0;
  const double cone_px = flat->Fire().flame_radius_m * flat->Fire().flame_height_m / (pixel_m * pixel_m);
  EXPECT_GT(open.fire_px, 0.8 * cone_px);
  EXPECT_LT(open.fire_px, 1.8 * cone_px);
  EXPECT_GT(open.smoke_px, 2 * open.fire_px);
  EXPECT_LT(open.occluded, 0.02);
}

TEST(Plume, AHalfHighRidgeHidesTheFlameAndLeavesTheSmoke) {
  const auto ridge = [](double x_m, double) {
    return 26.0 * std::max(0.0, 1.0 - std::abs(x_m - 200.0) / 40.0);
  };
  const auto scene = FireScene(ridge, {300, 200});
  const GroundTruth truth = TruthFrom(*scene, LookFrom(100, 200, 26, 0, 0));
  EXPECT_EQ(truth.fire_px, 0);
  EXPECT_GT(truth.smoke_px, 10);
  EXPECT_GT(truth.occluded, 0.2);
  EXPECT_LT(truth.occluded, 0.9);
}

TEST(Plume, TheFlameLandsWhereThePinholeEquationSays) {
  const auto scene = FireScene([](double, double) { return 0.0; }, {300, 230});
  const robot::Pose pose = LookFrom(200, 200, 30, 5.0, 10.0);
  const SensingConfig sensing;
  const PixelGrid grid{96, 54, 2};
  const TraceScene traced(*scene);
  const Ambience noon = Noon();
  const SensingTrace trace = traced.Trace(pose, sensing, grid, noon, {});
  const PlumePhase phase;
  const PlumeLayers layers =
      TracePlume(trace, scene->Sites()[0], scene->Fire(), noon, FogLayer(), std::span(&phase, 1));
  ASSERT_EQ(layers.frames.size(), 1u);
  // The flame is the one thing that is much redder than blue.
  double sum_x = 0, sum_y = 0, sum = 0;
  for (int row = 0; row < layers.rows; ++row)
    for (int column = 0; column < layers.columns; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * layers.columns + column;
      const double weight = layers.frames[0].added.red[i] - 2.0 * layers.frames[0].added.blue[i];
      if (weight < 0.8) continue;
      sum_x += layers.left + column + 0.5 - grid.margin_px;
      sum_y += layers.top + row + 0.5 - grid.margin_px;
      sum += 1.0;
    }
  ASSERT_GT(sum, 5.0);
  const Camera camera(pose, sensing);
  const Eigen::Vector3d ray =
      Eigen::Vector3d(300, 230, 0.35 * scene->Fire().flame_height_m) - camera.PositionM();
  const double focal_px = 48.0 / camera.HalfWidth();
  const double depth_m = ray.dot(camera.Forward());
  EXPECT_NEAR(sum_x / sum, 48.0 + focal_px * ray.dot(camera.Right()) / depth_m, 1.5);
  EXPECT_NEAR(sum_y / sum, 27.0 + focal_px * ray.dot(camera.Down()) / depth_m, 1.5);
}

TEST(Plume, PixelsFallWithTheSquareOfTheDistance) {
  const auto scene = FireScene([](double, double) { return 0.0; }, {360, 200});
  const int near_px = TruthFrom(*scene, LookFrom(280, 200, 20, 0, 5)).fire_px;
  const int far_px = TruthFrom(*scene, LookFrom(200, 200, 20, 0, 5)).fire_px;
  EXPECT_NEAR(static_cast<double>(near_px) / far_px, 4.0, 1.2);
}

TEST(Plume, NoFireNoPixels) {
  const auto scene = FireScene([](double, double) { return 0.0; }, {300, 200});
  const GroundTruth truth = TruthFrom(*scene, LookFrom(200, 200, 20, 0, 5), -1);
  EXPECT_EQ(truth.fire_px + truth.smoke_px, 0);
  EXPECT_EQ(truth.distance_m, 0.0);
  // Behind the camera is as good as none.
  const GroundTruth behind = TruthFrom(*scene, LookFrom(200, 200, 20, 180, 5));
  EXPECT_EQ(behind.fire_px + behind.smoke_px, 0);
  EXPECT_EQ(behind.occluded, 0.0);
}

TEST(Plume, DistanceIsToTheFlame) {
  const auto scene = FireScene([](double, double) { return 0.0; }, {300, 200});
  EXPECT_NEAR(TruthFrom(*scene, LookFrom(200, 200, 7, 0, 0)).distance_m, 100.0, 0.1);
}

}  // namespace
}  // namespace ed3r::perception
