// The searched area: terrain, forest, fire sites, base stations, start area. Immutable, built once per world
// file and shared by all missions (paper: 3D Environment; R12, R31).
//
// Frame: x east, y north, z up, metres; origin at the south-west corner at the lowest ground; the area is
// [0, size.x] x [0, size.y] x [0, size.z].
// Threads: const members may be called from any thread.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "engine/world/geometry.h"

namespace ed3r::world {

// Regular elevation grid, nodes at (column * cell_m, row * cell_m), row 0 in the south.
struct Terrain {
  int columns = 0;
  int rows = 0;
  double cell_m = 0.0;
  std::vector<float> height_m;  // row-major, columns x rows

  // Height of the triangulated surface (each cell is split along its south-west to north-east diagonal), so
  // that it equals what rays and contacts meet. Positions outside are clamped to the edge.
  double HeightAt(double x_m, double y_m) const;
};

struct Tree {
  double x_m, y_m, ground_m;
  double height_m, trunk_radius_m, crown_radius_m, crown_depth_m;  // the crown fills the top crown_depth_m
};

struct FireSite {
  std::string name;
  Eigen::Vector3d base_m;  // on the ground
  bool known = false;      // used in the warm-up
};

struct BaseStation {
  std::string name;
  Eigen::Vector3d antenna_m;
  bool known = false;
};

// Missions start on a disc at a height drawn above ground; kept clear of trees.
struct StartArea {
  double x_m = 0.0, y_m = 0.0, radius_m = 0.0;
  double height_min_m = 0.0, height_max_m = 0.0;
};

// Shape of the fire, the same at every site (paper: 46 m high, smoke included): a flame cone and a smoke
// column that widens and leans.
struct FireShape {
  double flame_height_m = 14.0;
  double flame_radius_m = 6.0;
  double total_height_m = 46.0;
  double smoke_top_radius_m = 12.0;
  double lean_x_m = 8.0;  // horizontal offset of the smoke's top
  double lean_y_m = 4.0;
};

class Scene {
 public:
  // Reads a world file and builds everything. Throws UserError: one line with file:line:column, the value and
  // what is allowed, for unknown keys, NODATA holes, a grid that is too small, a site outside the terrain or
  // inside the ground.
  static std::shared_ptr<const Scene> Load(const std::string& world_file);

  struct Parts {
    std::string name;
    Eigen::Vector3d size_m;
    Terrain terrain;
    std::vector<Tree> trees;
    std::vector<FireSite> sites;
    std::vector<BaseStation> base_stations;
    StartArea start;
    FireShape fire;
    // What was made of the files beyond what they say by themselves (units, estimated crowns), a line each. No mission
    // meets it: it is not in the fingerprint.
    std::vector<std::string> notes;
  };
  explicit Scene(Parts parts);  // bakes the geometry; also for tests

  const std::string& Name() const { return parts_.name; }
  const Eigen::Vector3d& SizeM() const { return parts_.size_m; }
  const Terrain& Ground() const { return parts_.terrain; }
  const std::vector<Tree>& Trees() const { return parts_.trees; }
  const std::vector<FireSite>& Sites() const { return parts_.sites; }
  const std::vector<BaseStation>& BaseStations() const { return parts_.base_stations; }
  const StartArea& Start() const { return parts_.start; }
  const FireShape& Fire() const { return parts_.fire; }
  const std::vector<std::string>& Notes() const { return parts_.notes; }
  const StaticGeometry& Geometry() const { return *geometry_; }

  // SHA-256 of everything that a mission can meet; part of a result's identity.
  const std::string& Fingerprint() const { return fingerprint_; }

 private:
  Parts parts_;
  std::unique_ptr<StaticGeometry> geometry_;
  std::string fingerprint_;
};

}  // namespace ed3r::world
