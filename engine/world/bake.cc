#include "engine/world/bake.h"

#include <array>
#include <cstddef>

namespace ed3r::world {
namespace {

struct Corner {
  double x, y;
};

// Unit polygons, counter-clockwise from above; literals instead of cos and sin, whose last bit depends on the
// C library.
constexpr std::array<Corner, 5> kPentagon = {{{1.0, 0.0},
                                              {0.30901699437494742, 0.95105651629515357},
                                              {-0.80901699437494742, 0.58778525229247313},
                                              {-0.80901699437494742, -0.58778525229247313},
                                              {0.30901699437494742, -0.95105651629515357}}};
constexpr double kHalfRoot3 = 0.86602540378443865;
constexpr std::array<Corner, 6> kHexagon = {{{1.0, 0.0},
                                             {0.5, kHalfRoot3},
                                             {-0.5, kHalfRoot3},
                                             {-1.0, 0.0},
                                             {-0.5, -kHalfRoot3},
                                             {0.5, -kHalfRoot3}}};

// Shape of a crown: widest at 0.3 of its depth, tapering through 0.65 to a tip.
constexpr double kWidestAt = 0.3;
constexpr double kTaperAt = 0.65;
constexpr double kTaperRadius = 0.6;
// The trunk ends this share of the crown's depth above the crown's lowest point, well inside it.
constexpr double kTrunkInCrown = 0.2;
// Roots: deep enough that no slope on which trees stand shows the trunk's end.
constexpr double kRootDepthM = 1.0;

int AddVertex(TriangleMesh& mesh, double x, double y, double z) {
  mesh.vertices_m.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  return static_cast<int>(mesh.vertices_m.size()) - 1;
}

template <std::size_t kCorners>
int AddRing(TriangleMesh& mesh, const std::array<Corner, kCorners>& polygon, const Tree& tree,
            double radius_m, double z_m) {
  const int first = static_cast<int>(mesh.vertices_m.size());
  for (const Corner& corner : polygon)
    AddVertex(mesh, tree.x_m + radius_m * corner.x, tree.y_m + radius_m * corner.y, z_m);
  return first;
}

void AddBand(TriangleMesh& mesh, int corners, int lower, int upper) {
  for (int i = 0; i < corners; ++i) {
    const int next = (i + 1) % corners;
    mesh.triangles.emplace_back(lower + i, lower + next, upper + next);
    mesh.triangles.emplace_back(lower + i, upper + next, upper + i);
  }
}

void AddTip(TriangleMesh& mesh, int corners, int ring, int tip, bool up) {
  for (int i = 0; i < corners; ++i) {
    const int next = (i + 1) % corners;
    mesh.triangles.emplace_back(up ? ring + i : ring + next, up ? ring + next : ring + i, tip);
  }
}

void AddTrunk(TriangleMesh& mesh, const Tree& tree) {
  constexpr int kCorners = static_cast<int>(kPentagon.size());
  const double top_m =
      tree.ground_m + tree.height_m - tree.crown_depth_m + kTrunkInCrown * tree.crown_depth_m;
  const int lower = AddRing(mesh, kPentagon, tree, tree.trunk_radius_m, tree.ground_m - kRootDepthM);
  const int upper = AddRing(mesh, kPentagon, tree, tree.trunk_radius_m, top_m);
  AddBand(mesh, kCorners, lower, upper);
  for (int i = 1; i + 1 < kCorners; ++i) {
    mesh.triangles.emplace_back(upper, upper + i, upper + i + 1);
    mesh.triangles.emplace_back(lower, lower + i + 1, lower + i);
  }
}

void AddCrown(TriangleMesh& mesh, const Tree& tree) {
  constexpr int kCorners = static_cast<int>(kHexagon.size());
  const double top_m = tree.ground_m + tree.height_m;
  const double bottom_m = top_m - tree.crown_depth_m;
  const double depth_m = tree.crown_depth_m;
  const int widest = AddRing(mesh, kHexagon, tree, tree.crown_radius_m, bottom_m + kWidestAt * depth_m);
  const int taper =
      AddRing(mesh, kHexagon, tree, kTaperRadius * tree.crown_radius_m, bottom_m + kTaperAt * depth_m);
  const int bottom = AddVertex(mesh, tree.x_m, tree.y_m, bottom_m);
  const int top = AddVertex(mesh, tree.x_m, tree.y_m, top_m);
  AddTip(mesh, kCorners, widest, bottom, /*up=*/false);
  AddBand(mesh, kCorners, widest, taper);
  AddTip(mesh, kCorners, taper, top, /*up=*/true);
}

void AddTerrain(TriangleMesh& mesh, const Terrain& terrain) {
  for (int row = 0; row < terrain.rows; ++row)
    for (int column = 0; column < terrain.columns; ++column)
      AddVertex(mesh, column * terrain.cell_m, row * terrain.cell_m,
                terrain.height_m[static_cast<std::size_t>(row) * terrain.columns + column]);
  for (int row = 0; row + 1 < terrain.rows; ++row) {
    for (int column = 0; column + 1 < terrain.columns; ++column) {
      const int south_west = row * terrain.columns + column;
      const int north_west = south_west + terrain.columns;
      mesh.triangles.emplace_back(south_west, south_west + 1, north_west + 1);
      mesh.triangles.emplace_back(south_west, north_west + 1, north_west);
    }
  }
}

}  // namespace

TriangleMesh Bake(const Terrain& terrain, const std::vector<Tree>& trees) {
  TriangleMesh mesh;
  const std::size_t cells = static_cast<std::size_t>(terrain.columns - 1) * (terrain.rows - 1);
  mesh.triangles.reserve(2 * cells + kTrianglesPerTree * trees.size());
  AddTerrain(mesh, terrain);
  for (const Tree& tree : trees) {
    AddTrunk(mesh, tree);
    AddCrown(mesh, tree);
  }
  return mesh;
}

}  // namespace ed3r::world
