// What a world file says of its stem map.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>

#include "engine/world/files/text_place.h"
#include "engine/world/files/tree_allometry.h"

namespace ed3r::world {

// Trees from a stem map, a CSV of a real stand. A rectangle of the stand (offset_m from its south-west
// corner, extent_m) is tiled over the area, every other tile mirrored; a stand is seldom a rectangle, so
// choose one that it fills.
struct StemMapSpec {
  std::string file;
  Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();
  std::optional<Eigen::Vector2d> extent_m;  // none: all of the stand
  double height_scale = 1.0;                // heights, crown depths and trunks
  double crown_scale = 1.0;                 // crown radii
  double min_height_m = 3.0;                // after scaling; lower trees are left out
  double keep = 1.0;                        // share of the trees that stay, drawn from the seed
  // What stem_map.h calls a column -> what the file's header calls it.
  std::map<std::string, std::string> columns;
  std::optional<ForestKind> estimate_missing;  // crowns and trunks that were not measured (tree_allometry.h)
  bool tallest_of_a_spot = false;  // of trees at one spot the tallest stays; otherwise they are refused
  TextPlace file_place, columns_place;
};

}  // namespace ed3r::world
