// Stem maps: a CSV with one row per measured tree of a real stand.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ed3r {

struct Stem {
  double x_m, y_m;
  double height_m, crown_depth_m, crown_radius_m, trunk_radius_m;
};

struct StemMap {
  Eigen::Vector2d size_m;   // of the stand
  std::vector<Stem> stems;  // moved so that the stand begins at (0, 0)
};

// Lines that begin with # are comments; then a header that names at least the columns x_m, y_m, dbh_cm
// (diameter at breast height), height_m, crown_depth_m and crown_radius_m, in any order; then one row per
// tree. Throws UserError with file:line:column, the column's name, the value and what is allowed.
StemMap ReadStemMap(const std::string& file);

}  // namespace ed3r
