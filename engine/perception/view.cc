#include "engine/perception/view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/world/plume.h"

namespace ed3r::perception {
namespace {

constexpr int kFlameSamples = 32;
constexpr int kSmokeSamples = 48;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kDistractorHeightM = 0.5;  // above ground, so that the ground itself does not hide it

// Area that a body element shows to a ray which looks down at it: part of its side, part of its top.
double FacingArea(double side_m2, double top_m2, const Eigen::Vector3d& ray) {
  const double distance_m = ray.norm();
  const double down = std::abs(ray.z()) / distance_m;
  return side_m2 * std::sqrt(std::max(0.0, 1.0 - down * down)) + top_m2 * down;
}

// How much of a distractor's signal is left when it is seen along a ray (R34): nearly nothing from the side, all of it
// straight from above.
double Misleading(const Eigen::Vector3d& ray, const PerceptionConfig& perception) {
  const double steepness_deg = std::asin(std::clamp(-ray.z() / ray.norm(), -1.0, 1.0)) / kDegree;
  return 1.0 / (1.0 + std::exp((perception.distractor_tilt_deg - steepness_deg) /
                               perception.distractor_tilt_width_deg));
}

}  // namespace

std::vector<Distractor> DrawDistractors(const world::Scene& scene, const PerceptionConfig& perception,
                                        std::uint64_t seed, std::uint32_t scenario) {
  Stream stream(seed, scenario, Purpose::kDistractors);
  const Eigen::Vector3d& size_m = scene.SizeM();
  const double expected = perception.distractors_per_km2 * size_m.x() * size_m.y() * 1e-6;
  const int count = static_cast<int>(expected + stream.Uniform());
  std::vector<Distractor> distractors;
  distractors.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double x_m = stream.Uniform(0.0, size_m.x());
    const double y_m = stream.Uniform(0.0, size_m.y());
    // Log-normal with the given mean.
    const double sigma = perception.distractor_radius_sigma;
    const double radius_m =
        perception.distractor_radius_m * std::exp(sigma * stream.Normal() - 0.5 * sigma * sigma);
    distractors.push_back({{x_m, y_m, scene.Ground().HeightAt(x_m, y_m) + kDistractorHeightM}, radius_m});
  }
  return distractors;
}

Camera::Camera(const robot::Pose& pose, const SensingConfig& sensing) : position_m_(pose.position_m) {
  const double cos_yaw = std::cos(pose.yaw_rad), sin_yaw = std::sin(pose.yaw_rad);
  const double cos_tilt = std::cos(pose.tilt_rad), sin_tilt = std::sin(pose.tilt_rad);
  forward_ = {cos_yaw * cos_tilt, sin_yaw * cos_tilt, -sin_tilt};
  right_ = {sin_yaw, -cos_yaw, 0.0};
  down_ = forward_.cross(right_);
  half_width_ = std::tan(0.5 * sensing.camera_hfov_deg * kDegree);
  half_height_ = half_width_ * sensing.camera_height_px / sensing.camera_width_px;
}

double Camera::ShareOf(const Eigen::Vector3d& point_m, double area_m2) const {
  const Eigen::Vector3d ray = point_m - position_m_;
  const double depth_m = ray.dot(forward_);
  if (depth_m < 0.1) return 0.0;
  if (std::abs(ray.dot(right_)) > half_width_ * depth_m || std::abs(ray.dot(down_)) > half_height_ * depth_m)
    return 0.0;
  // A patch of area A facing the camera at distance r covers A / r^2 steradians; off the axis by theta the
  // image plane stretches that by 1 / cos^3(theta), with cos(theta) = depth / r.
  const double distance_m = ray.norm();
  const double image_area = area_m2 * distance_m / (depth_m * depth_m * depth_m);
  return image_area / (4.0 * half_width_ * half_height_);
}

FireView::FireView(const world::Scene& scene, int site) : scene_(scene) {
  ED3R_CHECK(site >= 0 && site < static_cast<int>(scene.Sites().size()), "site index");
  const world::FireShape& fire = scene.Fire();
  const Eigen::Vector3d base_m = scene.Sites()[static_cast<std::size_t>(site)].base_m;
  const double flame_side_m2 = fire.flame_radius_m * fire.flame_height_m;
  const double flame_top_m2 = std::numbers::pi * fire.flame_radius_m * fire.flame_radius_m;
  for (const Eigen::Vector3d& point : world::FlamePoints(fire, base_m, kFlameSamples))
    flame_.push_back({point, flame_side_m2 / kFlameSamples, flame_top_m2 / kFlameSamples});
  const double smoke_height_m = fire.total_height_m - fire.flame_height_m;
  const double smoke_side_m2 = (world::SmokeBottomRadiusM(fire) + fire.smoke_top_radius_m) * smoke_height_m;
  const double smoke_top_m2 = std::numbers::pi * fire.smoke_top_radius_m * fire.smoke_top_radius_m;
  for (const Eigen::Vector3d& point : world::SmokePoints(fire, base_m, kSmokeSamples))
    smoke_.push_back({point, smoke_side_m2 / kSmokeSamples, smoke_top_m2 / kSmokeSamples});
}

double FireView::VisibleShare(const Camera& camera, const std::vector<Sample>& samples, double haze_range_m,
                              int& visible) const {
  double share = 0.0;
  for (const Sample& sample : samples) {
    const Eigen::Vector3d ray = sample.position_m - camera.PositionM();
    const double in_frame = camera.ShareOf(sample.position_m, FacingArea(sample.side_m2, sample.top_m2, ray));
    if (in_frame <= 0.0 || scene_.Geometry().Occluded(camera.PositionM(), sample.position_m)) continue;
    share += in_frame * std::exp(-ray.norm() / haze_range_m);
    ++visible;
  }
  return std::min(share, 1.0);
}

View FireView::Look(const robot::Pose& pose, const SensingConfig& sensing, const PerceptionConfig& perception,
                    const std::vector<Distractor>& distractors) const {
  const Camera camera(pose, sensing);
  View view;
  int visible = 0;
  view.fire_share = VisibleShare(camera, flame_, perception.haze_range_m, visible);
  view.smoke_share = VisibleShare(camera, smoke_, perception.haze_range_m, visible);
  view.visible_fraction = static_cast<double>(visible) / (kFlameSamples + kSmokeSamples);
  view.fire_in_view = visible > 0;
  for (const Distractor& distractor : distractors) {
    const Eigen::Vector3d ray = distractor.position_m - camera.PositionM();
    const double disc_m2 = std::numbers::pi * distractor.radius_m * distractor.radius_m;
    const double share = std::min(1.0, camera.ShareOf(distractor.position_m, FacingArea(0.0, disc_m2, ray))) *
                         Misleading(ray, perception) * std::exp(-ray.norm() / perception.haze_range_m);
    if (share <= view.distractor_share ||
        scene_.Geometry().Occluded(camera.PositionM(), distractor.position_m))
      continue;
    view.distractor_share = share;
  }
  return view;
}

}  // namespace ed3r::perception
