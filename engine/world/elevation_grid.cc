#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/world/files/raster_file.h"
#include "engine/world/terrain.h"

namespace ed3r::world {
namespace {

class ElevationGrid {
 public:
  explicit ElevationGrid(const GridTerrainSpec& spec) : spec_(spec), raster_(spec) {}

  std::string Note() const { return raster_.Note(); }

  // The terrain's node (x, y) lies at offset + (x, y) * extent / size of the grid.
  Terrain Sample(const Eigen::Vector3d& size_m, double cell_m) {
    CheckExtent();
    CheckCells();
    Terrain terrain = FlatTerrain(size_m, cell_m);
    const double columns_per_node = spec_.extent_m.x() / (terrain.columns - 1) / raster_.cell_x_m();
    const double rows_per_node = spec_.extent_m.y() / (terrain.rows - 1) / raster_.cell_y_m();
    const double first_column = spec_.offset_m.x() / raster_.cell_x_m();
    const double first_row = spec_.offset_m.y() / raster_.cell_y_m();
    ReadWindow({first_column, first_row}, {first_column + columns_per_node * (terrain.columns - 1),
                                           first_row + rows_per_node * (terrain.rows - 1)});
    for (int row = 0; row < terrain.rows; ++row)
      for (int column = 0; column < terrain.columns; ++column)
        terrain.height_m[static_cast<std::size_t>(row) * terrain.columns + column] =
            static_cast<float>(spec_.height_scale * Height(first_column + columns_per_node * column,
                                                           first_row + rows_per_node * row));
    return terrain;
  }

 private:
  // Between cells that are wider apart than the area nothing is known.
  void CheckCells() const {
    const double columns = spec_.extent_m.x() / raster_.cell_x_m(),
                 rows = spec_.extent_m.y() / raster_.cell_y_m();
    if (columns >= 1.0 && rows >= 1.0 && (columns + 2) * (rows + 2) <= kMaxWindowCells) return;
    FailAt(spec_.extent_place,
           fmt::format(
               "terrain.grid: '{}' has cells of {:g} x {:g} m; allowed for an extent of [{:g}, {:g}] m: at "
               "least one a side, at most {:g} in all",
               spec_.file, raster_.cell_x_m(), raster_.cell_y_m(), spec_.extent_m.x(), spec_.extent_m.y(),
               kMaxWindowCells));
  }

  void CheckExtent() const {
    const double width_m = (raster_.columns() - 1) * raster_.cell_x_m();
    const double depth_m = (raster_.rows() - 1) * raster_.cell_y_m();
    const Eigen::Vector2d needed_m = spec_.offset_m + spec_.extent_m;
    constexpr double kRoundingM = 1e-6;
    if (needed_m.x() <= width_m + kRoundingM && needed_m.y() <= depth_m + kRoundingM) return;
    FailAt(
        spec_.extent_place,
        fmt::format("terrain.grid: '{}' is too small: offset_m + extent_m = [{:g}, {:g}] m; allowed: up to "
                    "[{:g}, {:g}] m ({} x {} cells of {:g} m)",
                    spec_.file, needed_m.x(), needed_m.y(), width_m, depth_m, raster_.columns(),
                    raster_.rows(), raster_.cell_x_m()));
  }

  // Reads the cells between two corners (in cells). Cells outside do not matter: a crop may touch the edge of the
  // grid, or a hole.
  void ReadWindow(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    constexpr double kRounding = 1e-9;
    window_.first_column = static_cast<int>(std::floor(low.x() + kRounding));
    window_.first_row = static_cast<int>(std::floor(low.y() + kRounding));
    window_.columns = static_cast<int>(std::ceil(high.x() - kRounding)) - window_.first_column + 1;
    window_.rows = static_cast<int>(std::ceil(high.y() - kRounding)) - window_.first_row + 1;
    // Two of a side at least, for the ground beyond to go on as steep.
    window_.columns = std::max(window_.columns, 2);
    window_.rows = std::max(window_.rows, 2);
    window_.first_column = std::min(window_.first_column, raster_.columns() - window_.columns);
    window_.first_row = std::min(window_.first_row, raster_.rows() - window_.rows);
    height_m_ = raster_.Read(window_);
  }

  // Beyond the window the ground goes on as steep as at its edge.
  double CellHeight(int column, int row) const {
    const int last_column = window_.first_column + window_.columns - 1;
    const int last_row = window_.first_row + window_.rows - 1;
    if (column < window_.first_column) return 2.0 * CellHeight(column + 1, row) - CellHeight(column + 2, row);
    if (column > last_column) return 2.0 * CellHeight(column - 1, row) - CellHeight(column - 2, row);
    if (row < window_.first_row) return 2.0 * CellHeight(column, row + 1) - CellHeight(column, row + 2);
    if (row > last_row) return 2.0 * CellHeight(column, row - 1) - CellHeight(column, row - 2);
    return height_m_[static_cast<std::size_t>(row - window_.first_row) * window_.columns +
                     (column - window_.first_column)];
  }

  // Catmull-Rom weights of the cells at -1, 0, 1, 2 for a position t in [0, 1].
  static std::array<double, 4> Weights(double t) {
    return {t * (t * (2.0 - t) - 1.0) / 2.0, (t * t * (3.0 * t - 5.0) + 2.0) / 2.0,
            t * (t * (4.0 - 3.0 * t) + 1.0) / 2.0, t * t * (t - 1.0) / 2.0};
  }

  double Height(double column, double row) const {
    // The last column and row are reached from the cell before them.
    const int west = std::clamp(static_cast<int>(column), window_.first_column,
                                window_.first_column + window_.columns - 2);
    const int south =
        std::clamp(static_cast<int>(row), window_.first_row, window_.first_row + window_.rows - 2);
    const std::array<double, 4> along_x = Weights(column - west);
    const std::array<double, 4> along_y = Weights(row - south);
    double height = 0.0;
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) height += along_y[j] * along_x[i] * CellHeight(west + i - 1, south + j - 1);
    return height;
  }

  const GridTerrainSpec& spec_;
  RasterFile raster_;
  CellWindow window_{};
  std::vector<double> height_m_;  // of the window, row-major from the south-west
};

}  // namespace

Terrain ReadElevationGrid(const GridTerrainSpec& spec, const Eigen::Vector3d& size_m, double cell_m,
                          std::vector<std::string>* notes) {
  ElevationGrid grid(spec);
  Terrain terrain = grid.Sample(size_m, cell_m);
  PutLowestAtZero(terrain);
  if (notes != nullptr && !grid.Note().empty()) notes->push_back(grid.Note());
  return terrain;
}

std::vector<std::string> ElevationGridFiles(const GridTerrainSpec& spec) { return RasterFile(spec).Files(); }

}  // namespace ed3r::world
