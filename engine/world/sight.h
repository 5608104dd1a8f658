// How much of a fire can be seen: geometry only, from fixed places, so that two sites or two worlds compare.
//
// A camera of SensingConfig's default looks level and is turned to the fire, so only its vertical field of view
// limits it. The sight from a place is the share of the plume's points (flame and smoke) that lie within that
// field and in line of sight; a sight is its mean over kViewpoints places.
// Threads: const members may be called from any thread. The arguments of the constructor must outlive it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/world/forest.h"
#include "engine/world/geometry.h"
#include "engine/world/scene.h"

namespace ed3r::world {

// Where the fire is looked at from; heights are above ground.
struct ViewArea {
  Eigen::Vector2d centre_m;
  double radius_m;
  double height_min_m, height_max_m;
};

ViewArea StartView(const StartArea& start);
// Any place where a mission may fly: within 150 m of the start's centre, 5 .. 100 m above ground.
ViewArea AroundStart(const StartArea& start);

class Sight {
 public:
  static constexpr int kViewpoints = 64;

  // Places spread evenly over the part of a view area that lies inside the searched area.
  Sight(const ViewArea& view, const Eigen::Vector3d& size_m, const Terrain& terrain, const FireShape& fire,
        const StaticGeometry& geometry, const std::vector<Tree>& trees);

  // Sight of a fire that stands at base_m: 0 .. 1. Trees whose crowns reach over one of the discs are taken as
  // felled: a site is measured before its clearing is made.
  double Of(const Eigen::Vector3d& base_m, std::span<const ClearDisc> felled = {}) const;

  const std::vector<Eigen::Vector3d>& ViewpointsM() const { return viewpoints_m_; }

 private:
  bool Felled(unsigned triangle, std::span<const ClearDisc> discs) const;
  int VisiblePoints(const Eigen::Vector3d& eye_m, std::span<const Eigen::Vector3d> points_m,
                    std::span<const ClearDisc> felled) const;
  bool Hidden(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& point_m, SurfaceHit hit,
              std::span<const ClearDisc> felled) const;

  const FireShape& fire_;
  const StaticGeometry& geometry_;
  const std::vector<Tree>& trees_;
  std::size_t ground_triangles_;
  std::vector<Eigen::Vector3d> viewpoints_m_;
};

}  // namespace ed3r::world
