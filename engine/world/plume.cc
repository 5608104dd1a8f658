#include "engine/world/plume.h"

#include <cmath>
#include <numbers>

#include "engine/core/low_discrepancy.h"

namespace ed3r::world {

std::vector<Eigen::Vector3d> FlamePoints(const FireShape& fire, const Eigen::Vector3d& base_m, int count) {
  std::vector<Eigen::Vector3d> points;
  // The silhouette narrows towards the tip, so heights are drawn with density 2 (1 - h).
  for (int i = 0; i < count; ++i) {
    const double h = 1.0 - std::sqrt(1.0 - RadicalInverse(i + 1, 2));
    const double radius_m = fire.flame_radius_m * (1.0 - h) * std::sqrt(RadicalInverse(i + 1, 3));
    const double angle = 2.0 * std::numbers::pi * RadicalInverse(i + 1, 5);
    points.push_back(base_m + Eigen::Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle),
                                              0.5 + h * (fire.flame_height_m - 0.5)));
  }
  return points;
}

std::vector<Eigen::Vector3d> SmokePoints(const FireShape& fire, const Eigen::Vector3d& base_m, int count) {
  std::vector<Eigen::Vector3d> points;
  const double smoke_height_m = fire.total_height_m - fire.flame_height_m;
  const double bottom_m = SmokeBottomRadiusM(fire);
  for (int i = 0; i < count; ++i) {
    const double h = RadicalInverse(i + 1, 2);
    const double radius_m =
        (bottom_m + h * (fire.smoke_top_radius_m - bottom_m)) * std::sqrt(RadicalInverse(i + 1, 3));
    const double angle = 2.0 * std::numbers::pi * RadicalInverse(i + 1, 5);
    points.push_back(base_m + Eigen::Vector3d(radius_m * std::cos(angle) + h * fire.lean_x_m,
                                              radius_m * std::sin(angle) + h * fire.lean_y_m,
                                              fire.flame_height_m + h * smoke_height_m));
  }
  return points;
}

}  // namespace ed3r::world
