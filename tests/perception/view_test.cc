#include "engine/perception/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ed3r::perception {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

robot::Pose At(double x_m, double y_m, double z_m, double yaw_deg, double tilt_deg) {
  return {{x_m, y_m, z_m}, yaw_deg * kDegree, tilt_deg * kDegree};
}

// Flat ground with one fire at (150, 100); with_ridge puts a 60 m ridge between x = 100 and x = 120.
world::Scene FlatScene(bool with_ridge, const world::FireShape& fire = {}) {
  world::Scene::Parts parts;
  parts.name = "flat";
  parts.size_m = {300, 200, 165};
  parts.terrain = {
      .columns = 151, .rows = 101, .cell_m = 2.0, .height_m = std::vector<float>(151 * 101, 0.0F)};
  if (with_ridge) {
    for (int row = 0; row < 101; ++row)
      for (int column = 50; column <= 60; ++column)
        parts.terrain.height_m[static_cast<std::size_t>(row * 151 + column)] = 60.0F;
  }
  parts.sites = {{.name = "fire", .base_m = {150, 100, 0}, .known = true}};
  parts.base_stations = {{.name = "station", .antenna_m = {10, 10, 10}, .known = true}};
  parts.start = {.x_m = 20, .y_m = 100, .radius_m = 5, .height_min_m = 10, .height_max_m = 20};
  parts.fire = fire;
  return world::Scene(parts);
}

TEST(CameraTest, PinholeFrame) {
  SensingConfig sensing;
  sensing.camera_hfov_deg = 90.0;  // half width 1, half height 9/16
  const Camera camera(At(0, 0, 10, 0, 0), sensing);
  EXPECT_GT(camera.ShareOf({10, 9.9, 10}, 1.0), 0.0);
  EXPECT_EQ(camera.ShareOf({10, 10.1, 10}, 1.0), 0.0);
  EXPECT_GT(camera.ShareOf({10, 0, 10 + 5.5}, 1.0), 0.0);
  EXPECT_EQ(camera.ShareOf({10, 0, 10 + 5.7}, 1.0), 0.0);
  EXPECT_EQ(camera.ShareOf({-10, 0, 10}, 1.0), 0.0);  // behind
  // On the axis at 10 m, 1 m^2 covers 1/100 of the unit image plane, whose frame is 2 x 9/8.
  EXPECT_NEAR(camera.ShareOf({10, 0, 10}, 1.0), 0.01 / (2.0 * 1.125), 1e-12);
}

TEST(CameraTest, YawAndTilt) {
  const SensingConfig sensing;
  EXPECT_GT(Camera(At(0, 0, 50, 90, 0), sensing).ShareOf({0, 20, 50}, 1.0), 0.0);  // 90 degrees is north
  EXPECT_GT(Camera(At(0, 0, 50, 33, 90), sensing).ShareOf({0, 0, 0}, 1.0), 0.0);   // straight down
  EXPECT_EQ(Camera(At(0, 0, 50, 0, 0), sensing).ShareOf({0, 0, 0}, 1.0), 0.0);
}

TEST(FireViewTest, SeenInTheOpenAndOnlyInItsDirection) {
  const world::Scene scene = FlatScene(false);
  const FireView fire(scene, 0);
  const Config config;
  const View facing = fire.Look(At(50, 100, 20, 0, 0), config.sensing, config.perception, {});
  EXPECT_TRUE(facing.fire_in_view);
  EXPECT_GT(facing.visible_fraction, 0.99);
  EXPECT_GT(facing.fire_share, 0.0);
  EXPECT_GT(facing.smoke_share, facing.fire_share);
  const View away = fire.Look(At(50, 100, 20, 180, 0), config.sensing, config.perception, {});
  EXPECT_FALSE(away.fire_in_view);
  EXPECT_EQ(away.fire_share + away.smoke_share, 0.0);
}

TEST(FireViewTest, ARidgeHidesIt) {
  const world::Scene scene = FlatScene(true);
  const FireView fire(scene, 0);
  const Config config;
  EXPECT_FALSE(fire.Look(At(50, 100, 20, 0, 0), config.sensing, config.perception, {}).fire_in_view);
  EXPECT_TRUE(fire.Look(At(50, 100, 110, 0, 30), config.sensing, config.perception, {}).fire_in_view);
}

// Twice the distance, a quarter of the image (haze aside), for a flame that is small against its distance.
TEST(FireViewTest, ShareFallsWithTheSquareOfDistance) {
  const world::Scene scene = FlatScene(false, {.flame_height_m = 1.0, .flame_radius_m = 0.3});
  const FireView fire(scene, 0);
  Config config;
  config.perception.haze_range_m = 1e6;
  const double near = fire.Look(At(70, 100, 1, 0, 0), config.sensing, config.perception, {}).fire_share;
  const double far = fire.Look(At(-10, 100, 1, 0, 0), config.sensing, config.perception, {}).fire_share;
  EXPECT_NEAR(near / far, 4.0, 0.02);
}

TEST(DistractorTest, MisleadsFromAboveOnly) {
  const world::Scene scene = FlatScene(false);
  const FireView fire(scene, 0);
  const Config config;
  const std::vector<Distractor> rock = {{{50, 100, 0.5}, 3.0}};
  const auto share = [&](const robot::Pose& pose, const std::vector<Distractor>& seen) {
    return fire.Look(pose, config.sensing, config.perception, seen).distractor_share;
  };
  const double above = share(At(50, 100, 30, 90, 85), rock);
  EXPECT_GT(above, 0.0);
  // From the side, 18 degrees down, the law leaves 0.7 %, and of that the flat disc shows a third.
  EXPECT_LT(share(At(20, 100, 10, 0, 10), rock), 0.01 * above);
  // Of several the one that misleads most counts, wherever it stands in the list.
  const Distractor small = {{51, 100, 0.5}, 1.0};
  EXPECT_EQ(share(At(50, 100, 30, 90, 85), {rock[0], small}), above);
  EXPECT_EQ(share(At(50, 100, 30, 90, 85), {small, rock[0]}), above);
}

TEST(DistractorTest, HowSteeplyDecidesByALogisticLaw) {
  const world::Scene scene = FlatScene(false);
  const FireView fire(scene, 0);
  Config config;
  config.perception.distractor_tilt_deg = 60;
  config.perception.distractor_tilt_width_deg = 4;
  config.perception.haze_range_m = 1e6;
  // The same rock at the same distance and in the same place of the image, seen at 60 and at 64 degrees below level: the
  // disc shows sin of the angle of its area, and the law leaves 1/2 and 1 / (1 + 1/e).
  const auto seen_at = [&](double steepness_deg) {
    const double angle = steepness_deg * std::numbers::pi / 180.0;
    const std::vector<Distractor> rock = {{{50 + 40 * std::cos(angle), 100, 90 - 40 * std::sin(angle)}, 0.5}};
    return fire.Look(At(50, 100, 90, 0, steepness_deg), config.sensing, config.perception, rock)
               .distractor_share /
           std::sin(angle);
  };
  EXPECT_NEAR(seen_at(64) / seen_at(60), 2.0 / (1.0 + std::exp(-1.0)), 1e-3);
  EXPECT_NEAR(seen_at(56) / seen_at(60), 2.0 / (1.0 + std::exp(1.0)), 1e-3);
}

TEST(DistractorTest, DrawnPerScenarioAndAtTheAskedDensity) {
  const world::Scene scene = FlatScene(false);
  PerceptionConfig perception;
  perception.distractors_per_km2 = 500;  // 30 on 0.06 km^2
  const auto first = DrawDistractors(scene, perception, 1, 1);
  EXPECT_EQ(first.size(), 30u);
  EXPECT_EQ(first[3].position_m, DrawDistractors(scene, perception, 1, 1)[3].position_m);
  EXPECT_NE(first[3].position_m, DrawDistractors(scene, perception, 1, 2)[3].position_m);
}

TEST(DistractorTest, RadiiHaveTheAskedMeanAndTail) {
  const world::Scene scene = FlatScene(false);
  PerceptionConfig perception;
  perception.distractors_per_km2 = 5000;
  perception.distractor_radius_m = 2.0;
  perception.distractor_radius_sigma = 0.8;
  double sum = 0.0, logarithms = 0.0, squares = 0.0;
  int count = 0;
  for (std::uint32_t scenario = 0; scenario < 40; ++scenario)
    for (const Distractor& distractor : DrawDistractors(scene, perception, 1, scenario)) {
      ++count;
      sum += distractor.radius_m;
      logarithms += std::log(distractor.radius_m);
      squares += std::log(distractor.radius_m) * std::log(distractor.radius_m);
    }
  const double mean_log = logarithms / count;
  EXPECT_NEAR(sum / count, 2.0, 0.06);
  EXPECT_NEAR(std::sqrt(squares / count - mean_log * mean_log), 0.8, 0.02);
}

}  // namespace
}  // namespace ed3r::perception
