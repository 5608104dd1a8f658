// Stem maps: a table with one row per measured tree of a real stand.
//
// A text table with a header; cells apart by commas, semicolons or tabs (told by the header), with decimal commas where
// they are not apart by commas; quotes, a byte-order mark, any line ends, lines that begin with #. The columns, in any
// order, by these names or by the names that the world file's `columns` gives them:
//
//   x_m | x_ft, y_m | y_ft                            east and north, in any projected system, not degrees
//   height_m | height_ft
//   dbh_cm | dbh_mm | dbh_m | dbh_in                  diameter at breast height
//   crown_depth_m | crown_depth_ft, or crown_base_m | crown_base_ft: the height where the crown begins
//   crown_radius_m | crown_radius_ft, or crown_diameter_m | crown_diameter_ft
//
// Crowns and diameters that are missing (no such column, an empty cell, NA, -9999) are estimated from the height where
// the world file says `estimate_missing: KIND` (tree_allometry.h), and refused otherwise.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/world/files/stem_map_spec.h"

namespace ed3r::world {

struct Stem {
  double x_m, y_m;
  double height_m, crown_depth_m, crown_radius_m, trunk_radius_m;
};

struct StemMap {
  Eigen::Vector2d size_m;          // of the stand
  std::vector<Stem> stems;         // moved so that the stand begins at (0, 0)
  std::vector<std::string> notes;  // what was estimated or left out, a line each
};

// Throws UserError with file:line:column, the column's name, the value and what is allowed; with what they look like
// where degrees stand for metres, mm for cm; for two trees at one spot (unless spec.tallest_of_a_spot).
StemMap ReadStemMap(const StemMapSpec& spec);

// The names above.
std::span<const std::string_view> StemColumnNames();

}  // namespace ed3r::world
