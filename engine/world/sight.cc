#include "engine/world/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/config/config.h"
#include "engine/core/low_discrepancy.h"
#include "engine/world/bake.h"
#include "engine/world/plume.h"

namespace ed3r::world {
namespace {

// One packet of rays per viewpoint; flame to smoke as FireView weighs them (32 : 48).
constexpr int kFlamePoints = 6;
constexpr int kSmokePoints = 10;
constexpr std::size_t kPoints = kFlamePoints + kSmokePoints;
constexpr double kMarginM = 0.01;  // as StaticGeometry::Occluded

// Tangent of the largest elevation angle in a level camera's frame.
double HalfHeight() {
  const SensingConfig camera;
  return std::tan(0.5 * camera.camera_hfov_deg * std::numbers::pi / 180.0) * camera.camera_height_px /
         camera.camera_width_px;
}

}  // namespace

ViewArea StartView(const StartArea& start) {
  return {{start.x_m, start.y_m}, start.radius_m, start.height_min_m, start.height_max_m};
}

ViewArea AroundStart(const StartArea& start) { return {{start.x_m, start.y_m}, 150.0, 5.0, 100.0}; }

Sight::Sight(const ViewArea& view, const Eigen::Vector3d& size_m, const Terrain& terrain,
             const FireShape& fire, const StaticGeometry& geometry, const std::vector<Tree>& trees)
    : fire_(fire),
      geometry_(geometry),
      trees_(trees),
      ground_triangles_(2 * static_cast<std::size_t>(terrain.columns - 1) * (terrain.rows - 1)) {
  for (int i = 1; static_cast<int>(viewpoints_m_.size()) < kViewpoints; ++i) {
    const double radius_m = view.radius_m * std::sqrt(RadicalInverse(i, 2));
    const double angle = 2.0 * std::numbers::pi * RadicalInverse(i, 3);
    const double x_m = view.centre_m.x() + radius_m * std::cos(angle);
    const double y_m = view.centre_m.y() + radius_m * std::sin(angle);
    if (x_m < 0.0 || y_m < 0.0 || x_m > size_m.x() || y_m > size_m.y()) continue;
    const double ground_m = terrain.HeightAt(x_m, y_m);
    const double room_m = std::max(0.0, size_m.z() - ground_m);
    const double low_m = std::min(view.height_min_m, room_m);
    const double high_m = std::min(view.height_max_m, room_m);
    viewpoints_m_.emplace_back(x_m, y_m, ground_m + low_m + RadicalInverse(i, 5) * (high_m - low_m));
  }
}

bool Sight::Felled(unsigned triangle, std::span<const ClearDisc> discs) const {
  if (triangle < ground_triangles_) return false;
  const Tree& tree = trees_[(triangle - ground_triangles_) / kTrianglesPerTree];
  return std::ranges::any_of(discs, [&](const ClearDisc& disc) {
    return std::hypot(tree.x_m - disc.x_m, tree.y_m - disc.y_m) <= disc.radius_m + tree.crown_radius_m;
  });
}

// Follows the ray on through felled trees.
bool Sight::Hidden(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& point_m, SurfaceHit hit,
                   std::span<const ClearDisc> felled) const {
  const double length_m = (point_m - eye_m).norm();
  const Eigen::Vector3d direction = (point_m - eye_m) / length_m;
  const std::array<Eigen::Vector3f, 1> ray = {direction.cast<float>()};
  std::array<SurfaceHit, 1> next = {hit};
  double way_m = 0.0;
  while (true) {
    way_m += next[0].distance_m;
    if (way_m >= length_m - kMarginM) return false;
    if (!Felled(next[0].triangle, felled)) return true;
    way_m += kMarginM;
    geometry_.FirstHits(eye_m + way_m * direction, ray, length_m - way_m, next);
  }
}

int Sight::VisiblePoints(const Eigen::Vector3d& eye_m, std::span<const Eigen::Vector3d> points_m,
                         std::span<const ClearDisc> felled) const {
  static const double half_height = HalfHeight();
  std::array<Eigen::Vector3f, kPoints> directions;
  std::array<const Eigen::Vector3d*, kPoints> framed;
  std::size_t count = 0;
  double range_m = 0.0;
  for (const Eigen::Vector3d& point : points_m) {
    const Eigen::Vector3d ray = point - eye_m;
    if (std::abs(ray.z()) > half_height * ray.head<2>().norm()) continue;
    const double length_m = ray.norm();
    if (length_m <= 2.0 * kMarginM) continue;
    range_m = std::max(range_m, length_m);
    directions[count] = (ray / length_m).cast<float>();
    framed[count++] = &point;
  }
  std::array<SurfaceHit, kPoints> hits;
  geometry_.FirstHits(eye_m, std::span(directions).first(count), range_m, std::span(hits).first(count));
  int visible = 0;
  for (std::size_t i = 0; i < count; ++i) visible += !Hidden(eye_m, *framed[i], hits[i], felled);
  return visible;
}

double Sight::Of(const Eigen::Vector3d& base_m, std::span<const ClearDisc> felled) const {
  std::vector<Eigen::Vector3d> points_m = FlamePoints(fire_, base_m, kFlamePoints);
  for (const Eigen::Vector3d& point : SmokePoints(fire_, base_m, kSmokePoints)) points_m.push_back(point);
  int visible = 0;
  for (const Eigen::Vector3d& eye_m : viewpoints_m_) visible += VisiblePoints(eye_m, points_m, felled);
  return static_cast<double>(visible) / static_cast<double>(points_m.size() * viewpoints_m_.size());
}

}  // namespace ed3r::world
