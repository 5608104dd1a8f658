#include "engine/world/terrain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ed3r::world {

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

Terrain FlatTerrain(const Eigen::Vector3d& size_m, double cell_m) {
  Terrain terrain;
  terrain.columns = static_cast<int>(std::lround(size_m.x() / cell_m)) + 1;
  terrain.rows = static_cast<int>(std::lround(size_m.y() / cell_m)) + 1;
  terrain.cell_m = cell_m;
  terrain.height_m.assign(static_cast<std::size_t>(terrain.columns) * terrain.rows, 0.0f);
  return terrain;
}

void PutLowestAtZero(Terrain& terrain) {
  const float lowest = *std::min_element(terrain.height_m.begin(), terrain.height_m.end());
  for (float& height : terrain.height_m) height -= lowest;
}

}  // namespace ed3r::world
