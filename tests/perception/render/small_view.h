// A small world to look at: flat ground or whatever a test needs, one fire in the middle, clear weather, nothing drawn.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "engine/perception/render/renderer.h"
#include "tests/world/scene_builder.h"

namespace ed3r::perception {

inline constexpr double kPi = 3.14159265358979323846;

inline std::shared_ptr<const world::Scene> FireScene(const std::function<double(double, double)>& height_m,
                                                     Eigen::Vector2d fire_m,
                                                     std::vector<world::Tree> trees = {}) {
  world::Scene::Parts parts = world::PartsOf(201, 2.0, height_m, std::move(trees));
  parts.sites.push_back({"fire", {fire_m.x(), fire_m.y(), height_m(fire_m.x(), fire_m.y())}, true});
  parts.start = {20.0, 20.0, 5.0, 20.0, 40.0};
  return std::make_shared<world::Scene>(std::move(parts));
}

// No distractors, always the same noon.
inline PerceptionConfig ClearView() {
  PerceptionConfig perception;
  perception.distractors_per_km2 = 0.0;
  perception.render.weather = 0.0;
  return perception;
}

inline robot::Pose LookFrom(double x_m, double y_m, double z_m, double yaw_deg, double tilt_deg) {
  robot::Pose pose;
  pose.position_m = {x_m, y_m, z_m};
  pose.yaw_rad = yaw_deg * kPi / 180.0;
  pose.tilt_rad = tilt_deg * kPi / 180.0;
  return pose;
}

inline Ambience Noon() { return DrawAmbience(ClearView(), 1, 1); }

}  // namespace ed3r::perception
