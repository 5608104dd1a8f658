#include "engine/robot/lidar.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/check.h"
#include "engine/core/phase.h"

namespace ed3r::robot {
namespace {

// Between neighbouring rays. A trunk of radius 0.15 m stops two or three columns of rays, and the tip of a
// crown that fits between them is thinner than the margin around the robot.
constexpr double kRaySpacingM = 0.10;
// Wider tubes spread the same number of rays, down to one column per thinnest trunk.
constexpr int kUsualRays = 160;
constexpr double kWidestSpacingM = 0.25;
// For tracking error, the parts of a tree that fit between two rays, and the 4 cm by which Bullet thickens the
// scene; gusts push the robot further off its line.
constexpr double kTubeMarginM = 0.20;
constexpr double kTubeMarginGustS = 0.10;

// Points spread evenly over a disc (Vogel's spiral): whatever straight edge enters the tube meets one soon.
std::vector<Eigen::Vector2d> SpreadOverDisc(double radius_m) {
  const double area_m2 = std::numbers::pi * radius_m * radius_m;
  const double usual_m = std::sqrt(area_m2 / kUsualRays);
  const double spacing_m = std::clamp(usual_m, kRaySpacingM, kWidestSpacingM);
  const int count = static_cast<int>(std::ceil(area_m2 / (spacing_m * spacing_m)));
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < count; ++i) {
    const double r = radius_m * std::sqrt((i + 0.5) / count);
    points.emplace_back(r * std::cos(i * golden_angle), r * std::sin(i * golden_angle));
  }
  return points;
}

}  // namespace

double TubeMarginM(const EnvironmentConfig& environment) {
  return kTubeMarginM + kTubeMarginGustS * environment.gust_mps;
}

LidarBundle::LidarBundle(const world::StaticGeometry& geometry, double tube_radius_m, double range_m)
    : geometry_(geometry), range_m_(range_m), offset_m_(SpreadOverDisc(tube_radius_m)) {}

double LidarBundle::FreeDistance(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& direction) const {
  const InPhase lidar(Phase::kLidar);
  const bool upright = std::abs(direction.z()) > 0.7;
  const Eigen::Vector3d across =
      direction.cross(upright ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d other = direction.cross(across);
  double nearest_m = range_m_;
  bool hit = false;
  for (const Eigen::Vector2d& offset : offset_m_) {
    // Only what is nearer than the nearest so far counts.
    const double distance_m =
        geometry_.Distance(centre_m + offset.x() * across + offset.y() * other, direction, nearest_m);
    if (distance_m > nearest_m) continue;
    nearest_m = distance_m;
    hit = true;
  }
  return hit ? nearest_m : std::numeric_limits<double>::infinity();
}

LegWatch::LegWatch(const LidarBundle& bundle, const Rule& rule, const Eigen::Vector3d& start_m,
                   const Eigen::Vector3d& direction)
    : bundle_(bundle), rule_(rule), start_m_(start_m), direction_(direction) {
  Scan(start_m);
}

void LegWatch::Scan(const Eigen::Vector3d& position_m) {
  const double along_m = (position_m - start_m_).dot(direction_);
  // An obstacle once seen stays known, also when the robot has drifted past its edge.
  obstacle_m_ = std::min(obstacle_m_, along_m + bundle_.FreeDistance(position_m, direction_));
  seen_m_ = along_m + bundle_.RangeM();
  scanned_from_m_ = position_m;
  ++scans_;
}

void LegWatch::Tick(const Eigen::Vector3d& position_m, double wanted_m) {
  const Eigen::Vector3d moved = position_m - scanned_from_m_;
  const double drift_m = (moved - moved.dot(direction_) * direction_).norm();
  if (drift_m > rule_.drift_m || OutOfSight(wanted_m)) Scan(position_m);
}

}  // namespace ed3r::robot
