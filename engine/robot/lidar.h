// Obstacle sensing (paper: Obstacle Avoidance Mechanism; R24).
//
// Six LiDARs look along +-x, +-y and +-z of the yaw-stabilised body and see all around together. Those that
// face the direction of motion probe it with a bundle of parallel rays: as wide as the robot in any attitude
// plus a margin for its tracking error, and denser than the thinnest trunk. A scan's answer is the distance
// from the robot's centre to the first surface inside that tube.
// Threads: const members may be called from any thread.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <vector>

#include "engine/config/environment.h"
#include "engine/world/geometry.h"

namespace ed3r::robot {

// Around the robot inside the LiDARs' tube.
double TubeMarginM(const EnvironmentConfig& environment);

class LidarBundle {
 public:
  // tube_radius_m: of the tube that the rays fill; range_m: beyond it nothing is seen.
  LidarBundle(const world::StaticGeometry& geometry, double tube_radius_m, double range_m);

  // Distance to the first surface in the tube along a unit direction, or +infinity when none is within range.
  double FreeDistance(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& direction) const;

  double RangeM() const { return range_m_; }
  int Rays() const { return static_cast<int>(offset_m_.size()); }

 private:
  const world::StaticGeometry& geometry_;
  double range_m_;
  std::vector<Eigen::Vector2d> offset_m_;  // across the tube
};

// Watches one straight leg: how far along it the robot may come to rest. Positions along the leg are measured
// from its start.
//
// The scene is static and the leg is straight, so that most scans of the LiDARs' 24 a second would only
// repeat the last one: a ray sent again from further along the same line meets the same surface. A scan is
// therefore taken only when it can say something new: at the start; when the robot has drifted off the line
// of the last scan by more than half the margin; and when the leg's end, or the point up to which the robot
// could brake, is no longer within what was seen.
class LegWatch {
 public:
  struct Rule {
    double stand_off_m = 0.0;  // centre of the robot to the nearest surface ahead, at rest
    double drift_m = 0.0;      // off the last scan's line, from which a new scan is due
  };

  LegWatch(const LidarBundle& bundle, const Rule& rule, const Eigen::Vector3d& start_m,
           const Eigen::Vector3d& direction);

  // A tick of the LiDARs: the robot's position, and up to where along the leg a view is wanted.
  void Tick(const Eigen::Vector3d& position_m, double wanted_m);

  // Whether a point along the leg is not yet seen to be free, nor known to lie behind an obstacle.
  bool OutOfSight(double along_m) const {
    return seen_m_ < obstacle_m_ && along_m > seen_m_ - rule_.stand_off_m;
  }

  // Furthest point along the leg at which the robot may rest, from what was seen so far.
  double RestLimitM() const { return std::min(obstacle_m_, seen_m_) - rule_.stand_off_m; }

  int Scans() const { return scans_; }

 private:
  void Scan(const Eigen::Vector3d& position_m);

  const LidarBundle& bundle_;
  Rule rule_;
  Eigen::Vector3d start_m_;
  Eigen::Vector3d direction_;
  Eigen::Vector3d scanned_from_m_ = Eigen::Vector3d::Zero();
  double obstacle_m_ = std::numeric_limits<double>::infinity();
  double seen_m_ = 0.0;
  int scans_ = 0;
};

}  // namespace ed3r::robot
