#include "engine/perception/render/trace.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/core/check.h"
#include "tests/perception/render/small_view.h"

namespace ed3r::perception {
namespace {

constexpr PixelGrid kGrid{96, 54, 2};

std::size_t PixelAt(const PixelGrid& grid, double x_px, double y_px) {
  const int column = static_cast<int>(std::floor(x_px)) + grid.margin_px;
  const int row = static_cast<int>(std::floor(y_px)) + grid.margin_px;
  return static_cast<std::size_t>(row) * grid.Columns() + static_cast<std::size_t>(column);
}

// Where the pinhole equation puts a point: focal length in pixels times x/z, from the picture's middle.
Eigen::Vector2d Pinhole(const robot::Pose& pose, const SensingConfig& sensing, const PixelGrid& grid,
                        const Eigen::Vector3d& point_m) {
  const double focal_px = 0.5 * grid.width_px / std::tan(0.5 * sensing.camera_hfov_deg * kPi / 180.0);
  const Eigen::Vector3d forward(std::cos(pose.yaw_rad) * std::cos(pose.tilt_rad),
                                std::sin(pose.yaw_rad) * std::cos(pose.tilt_rad), -std::sin(pose.tilt_rad));
  const Eigen::Vector3d right(std::sin(pose.yaw_rad), -std::cos(pose.yaw_rad), 0.0);
  const Eigen::Vector3d down = forward.cross(right);
  const Eigen::Vector3d ray = point_m - pose.position_m;
  return {0.5 * grid.width_px + focal_px * ray.dot(right) / ray.dot(forward),
          0.5 * grid.height_px + focal_px * ray.dot(down) / ray.dot(forward)};
}

Prop House(float x_m, float y_m) {
  Prop house;
  house.kind = PropKind::kVehicle;
  house.position_m = {x_m, y_m, 0.0f};
  house.half_size_m = {3.0f, 4.0f, 5.0f};
  house.radius_m = 12.0f;
  return house;
}

TEST(Trace, ABoxLandsWhereThePinholeEquationSays) {
  const auto scene = FireScene([](double, double) { return 0.0; }, {380, 380});
  const TraceScene traced(*scene);
  const robot::Pose pose = LookFrom(100, 200, 20, 7.0, 12.0);
  const SensingConfig sensing;
  const Prop box = House(150.0f, 200.0f);
  const SensingTrace trace = traced.Trace(pose, sensing, kGrid, Noon(), std::span(&box, 1));

  // The front face lies at x = 147 between y = 196 and 204, z from 0 to 10: inside, just beyond each edge.
  const auto material = [&](double y_m, double z_m) {
    const Eigen::Vector2d at = Pinhole(pose, sensing, kGrid, {147.0, y_m, z_m});
    return trace.material[PixelAt(kGrid, at.x(), at.y())];
  };
  const double pixel_m = 50.0 * trace.pixel_rad;  // what a pixel covers there
  EXPECT_EQ(material(200.0, 5.0), Material::kProp);
  EXPECT_EQ(material(196.0 + pixel_m, 5.0), Material::kProp);
  EXPECT_EQ(material(204.0 - pixel_m, 5.0), Material::kProp);
  EXPECT_EQ(material(196.0 - pixel_m, 5.0), Material::kTerrain);
  EXPECT_EQ(material(204.0 + pixel_m, 5.0), Material::kTerrain);
  EXPECT_EQ(material(200.0, 10.0 - pixel_m), Material::kProp);
}

TEST(Trace, DistancesAndNormalsAreThoseOfTheGround) {
  const auto scene = FireScene([](double x_m, double) { return 0.25 * x_m; }, {380, 380});
  const TraceScene traced(*scene);
  const robot::Pose pose = LookFrom(200, 200, 110, 0.0, 90.0);
  const SensingTrace trace = traced.Trace(pose, SensingConfig(), kGrid, Noon(), {});
  const Eigen::Vector3f up = Eigen::Vector3f(-0.25f, 0.0f, 1.0f).normalized();
  for (std::size_t i = 0; i < kGrid.Pixels(); ++i) {
    ASSERT_EQ(trace.material[i], Material::kTerrain);
    const Eigen::Vector3f point_m = trace.PointM(i);
    EXPECT_NEAR(point_m.z(), 0.25f * point_m.x(), 2e-3f);
    EXPECT_NEAR((trace.normal[i] - up).norm(), 0.0f, 1e-4f);
  }
}

TEST(Trace, PacketsMeetWhatSingleRaysMeet) {
  std::vector<world::Tree> trees;
  for (int i = 0; i < 60; ++i)
    trees.push_back({.x_m = 120.0 + 13.0 * (i % 10),
                     .y_m = 150.0 + 17.0 * (i / 10),
                     .ground_m = 0,
                     .height_m = 12.0 + i % 7,
                     .trunk_radius_m = 0.3,
                     .crown_radius_m = 2.5,
                     .crown_depth_m = 8});
  const auto scene = FireScene([](double, double) { return 0.0; }, {380, 380}, trees);
  const robot::Pose pose = LookFrom(90, 190, 18, 3, 8);
  const Ambience noon = Noon();
  const SensingTrace trace = TraceScene(*scene).Trace(pose, SensingConfig(), kGrid, noon, {});
  int met = 0;
  for (std::size_t i = 0; i < kGrid.Pixels(); ++i) {
    const Eigen::Vector3d direction = trace.direction[i].cast<double>();
    const double single_m = scene->Geometry().Distance(pose.position_m, direction, 2000.0);
    if (trace.material[i] == Material::kSky || trace.material[i] == Material::kFarGround) {
      EXPECT_TRUE(std::isinf(single_m)) << i;
      continue;
    }
    ++met;
    EXPECT_NEAR(trace.distance_m[i], single_m, 1e-3 + 1e-4 * single_m) << i;
    if (trace.material[i] != Material::kTerrain) continue;
    const Eigen::Vector3d point_m = trace.PointM(i).cast<double>() + Eigen::Vector3d(0, 0, 0.05);
    const bool hidden = scene->Geometry().Occluded(point_m, point_m + 590.0 * noon.to_sun.cast<double>());
    EXPECT_EQ(trace.sunlit[i], hidden ? 0 : 1) << i;
  }
  EXPECT_GT(met, 2000);
}

TEST(Trace, ATreeHidesTheGroundAndIsKnownByItsIndex) {
  const world::Tree tree{.x_m = 150,
                         .y_m = 200,
                         .ground_m = 0,
                         .height_m = 20,
                         .trunk_radius_m = 0.4,
                         .crown_radius_m = 3,
                         .crown_depth_m = 12};
  world::Tree other = tree;
  other.x_m = 390;
  const auto scene = FireScene([](double, double) { return 0.0; }, {380, 380}, {other, tree});
  const robot::Pose pose = LookFrom(120, 200, 14, 0.0, 0.0);
  const SensingTrace trace = TraceScene(*scene).Trace(pose, SensingConfig(), kGrid, Noon(), {});
  const SensingConfig sensing;
  const auto at = [&](double z_m) {
    const Eigen::Vector2d px = Pinhole(pose, sensing, kGrid, {150.0, 200.0, z_m});
    return PixelAt(kGrid, px.x(), px.y());
  };
  EXPECT_EQ(trace.material[at(13.0)], Material::kCrown);
  EXPECT_EQ(trace.item[at(13.0)], 1);
  EXPECT_NEAR(trace.distance_m[at(12.0)], 27.0f, 1.0f);
  EXPECT_EQ(trace.material[at(4.0)], Material::kTrunk);
  EXPECT_EQ(trace.material[at(24.0)], Material::kSky);
}

TEST(Trace, TheShadowOfATreeFallsAwayFromTheSun) {
  const world::Tree tree{.x_m = 200,
                         .y_m = 200,
                         .ground_m = 0,
                         .height_m = 20,
                         .trunk_radius_m = 0.4,
                         .crown_radius_m = 4,
                         .crown_depth_m = 12};
  const auto scene = FireScene([](double, double) { return 0.0; }, {380, 380}, {tree});
  Ambience ambience = Noon();
  ambience.to_sun = Eigen::Vector3f(1.0f, 0.0f, 1.0f).normalized();
  const robot::Pose pose = LookFrom(200, 200, 90, 0.0, 90.0);
  const SensingConfig sensing;
  const SensingTrace trace = TraceScene(*scene).Trace(pose, sensing, kGrid, ambience, {});
  // The crown's middle, 13 m up, shades the ground 13 m west of the tree.
  const Eigen::Vector2d west = Pinhole(pose, sensing, kGrid, {187.0, 200.0, 0.0});
  const Eigen::Vector2d east = Pinhole(pose, sensing, kGrid, {213.0, 200.0, 0.0});
  EXPECT_EQ(trace.sunlit[PixelAt(kGrid, west.x(), west.y())], 0);
  EXPECT_EQ(trace.sunlit[PixelAt(kGrid, east.x(), east.y())], 1);
}

TEST(Trace, RefusesAnEmptyPicture) {
  const auto scene = FireScene([](double, double) { return 0.0; }, {200, 200});
  EXPECT_THROW(
      TraceScene(*scene).Trace(LookFrom(100, 100, 20, 0, 0), SensingConfig(), {0, 54, 0}, Noon(), {}),
      InternalError);
}

}  // namespace
}  // namespace ed3r::perception
