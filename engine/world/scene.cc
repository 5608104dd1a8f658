#include "engine/world/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "engine/core/check.h"
#include "engine/world/bake.h"
#include "engine/world/fingerprint.h"

namespace ed3r::world {
namespace {

void CheckTerrain(const Terrain& terrain) {
  ED3R_CHECK(terrain.columns >= 2 && terrain.rows >= 2 && terrain.cell_m > 0.0,
             fmt::format("{} x {} nodes, {} m apart", terrain.columns, terrain.rows, terrain.cell_m));
  ED3R_CHECK(terrain.height_m.size() == static_cast<std::size_t>(terrain.columns) * terrain.rows,
             fmt::format("{} heights", terrain.height_m.size()));
}

// A mission starts anywhere on the disc: no crown may reach over it, whatever the height drawn.
void CheckStartIsClear(const StartArea& start, const std::vector<Tree>& trees) {
  if (start.height_max_m <= 0.0) return;  // a scene without a start area
  for (const Tree& tree : trees) {
    const double distance_m = std::hypot(tree.x_m - start.x_m, tree.y_m - start.y_m);
    ED3R_CHECK(distance_m > start.radius_m + tree.crown_radius_m,
               fmt::format("a tree at ({}, {}) reaches over the start area", tree.x_m, tree.y_m));
  }
}

}  // namespace

Scene::Scene(Parts parts) : parts_(std::move(parts)) {
  CheckTerrain(parts_.terrain);
  CheckStartIsClear(parts_.start, parts_.trees);
  geometry_ = std::make_unique<StaticGeometry>(Bake(parts_.terrain, parts_.trees));
  fingerprint_ = SceneFingerprint(parts_, geometry_->Mesh());
}

}  // namespace ed3r::world
