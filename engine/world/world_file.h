// World files (YAML): what a scene is made of, as its author wrote it. Reading checks keys, types and ranges;
// Scene::Load then builds it and checks what depends on the ground. Lengths in metres, positions from the
// area's south-west corner, east first.
//
// `base: other.yaml` takes over every top-level key of another world file; those that stand here replace them
// whole. A file that is named in a base lies relative to that base.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/world/files/grid_spec.h"
#include "engine/world/files/stem_map_spec.h"
#include "engine/world/files/text_place.h"
#include "engine/world/scene.h"

namespace ed3r::world {

// A mountain ridge along a line; noise bends it and cuts spurs and saddles into it.
struct RidgeSpec {
  std::vector<Eigen::Vector2d> crest_m;
  double height_m = 0.0;      // above the hills that it stands on
  double half_width_m = 0.0;  // from the crest to the foot
};

// Terrain from a seed: rolling hills, ridges on top, a rough surface over all.
struct GeneratedTerrainSpec {
  double hills_height_m = 30.0;
  double hills_size_m = 220.0;  // from one hilltop to the next, about
  double bend_m = 18.0;         // how far noise moves hills and ridges sideways
  double spurs = 0.35;          // 0: even flanks; 1: deeply cut ones
  double saddles = 0.25;        // largest share of a ridge's height that a saddle lacks
  double roughness_m = 1.5;
  std::vector<RidgeSpec> ridges;
};

// Trees from a seed: one per cell of a jittered grid, save in clearings and on steep ground.
struct GeneratedForestSpec {
  double spacing_m = 8.0;
  double cover = 0.85;  // share of the area that is forest
  double clearing_size_m = 90.0;
  Eigen::Vector2d height_m{8.0, 25.0};
  Eigen::Vector2d crown_radius_m{1.5, 3.5};
};

struct ForestSpec {
  double slope_max = 0.85;  // rise over run; steeper ground is bare
  double site_clear_m = 14.0;
  double station_clear_m = 8.0;
  double start_clear_m = 3.0;  // around the start disc
  std::optional<GeneratedForestSpec> generated;
  std::optional<StemMapSpec> stem_map;
  TextPlace place;
};

// A named point on the ground, or at a height of its own. Its place is written as at_m, or from_start
// {distance_m, bearing_deg}: on the ground, seen from the start's centre, bearing clockwise from north.
struct PointSpec {
  std::string name;
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  bool from_start = false;
  std::optional<double> z_m;
  double above_ground_m = 0.0;  // without z_m
  bool known = false;
  TextPlace place;
};

// Sites that are drawn from a seed instead of written down. Each lies in the ring distance_m around the start's
// centre, uniformly by area, inside the area, apart_m from the others, and its `sight_around` (measures.h)
// lies in in_sight: the narrower that is, the more alike the sites are. Their order goes around the start.
struct PlacedSitesSpec {
  std::uint64_t seed = 0;
  int known = 0;
  int unseen = 0;
  Eigen::Vector2d distance_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d in_sight{0.0, 1.0};
  double apart_m = 40.0;
  TextPlace place;
};

struct WorldSpec {
  std::string file;
  std::vector<std::string> bases;  // the files that it takes over, nearest first, as the program opens them
  std::string name;
  std::uint64_t seed = 0;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  TextPlace size_place;
  double cell_m = 2.0;
  std::optional<GeneratedTerrainSpec> generated;
  std::optional<GridTerrainSpec> grid;
  std::optional<ForestSpec> forest;  // none: bare ground
  std::vector<PointSpec> sites;
  std::optional<PlacedSitesSpec> placed_sites;  // then `sites` is empty
  std::vector<PointSpec> base_stations;
  StartArea start;
  TextPlace start_place;
  FireShape fire;
};

// Throws UserError: one line with file:line:column, the key, the value, what is allowed, the nearest known
// key.
WorldSpec ReadWorldFile(const std::string& file);

// The files that make the world: the world file, those that it takes over, its grid and its stem map.
std::vector<std::string> FilesOf(const WorldSpec& spec);

}  // namespace ed3r::world
