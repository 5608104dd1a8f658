#include <algorithm>
#include <cstddef>

#include "engine/world/scene.h"

namespace ed3r {

double Terrain::HeightAt(double x_m, double y_m) const {
  const double column = std::clamp(x_m / cell_m, 0.0, columns - 1.0);
  const double row = std::clamp(y_m / cell_m, 0.0, rows - 1.0);
  const int west = std::min(static_cast<int>(column), columns - 2);
  const int south = std::min(static_cast<int>(row), rows - 2);
  const double u = column - west;
  const double v = row - south;
  const std::size_t at = static_cast<std::size_t>(south) * columns + west;
  const double south_west = height_m[at];
  const double south_east = height_m[at + 1];
  const double north_west = height_m[at + columns];
  const double north_east = height_m[at + columns + 1];
  return u >= v ? south_west + u * (south_east - south_west) + v * (north_east - south_east)
                : south_west + v * (north_west - south_west) + u * (north_east - north_west);
}

}  // namespace ed3r
