// Real elevation grids: crop, resampling, scale, and both file formats.
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/world/scene.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

double Bumps(int column, int row) {
  return std::round(1e3 * (40.0 + 9.0 * std::sin(0.9 * column) + 7.0 * std::cos(0.7 * row + 0.2 * column))) /
         1e3;
}

// The same cells as a GeoTIFF, first row in the north.
void WriteTiff(const std::string& path, int columns, int rows, double cell_m) {
  GDALRegister_GTiff();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDataset* dataset = driver->Create(path.c_str(), columns, rows, 1, GDT_Float32, nullptr);
  ASSERT_NE(dataset, nullptr);
  double transform[6] = {1000.0, cell_m, 0.0, 2000.0 + rows * cell_m, 0.0, -cell_m};
  dataset->SetGeoTransform(transform);
  dataset->GetRasterBand(1)->SetNoDataValue(-9999);
  std::vector<float> line(columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      line[column] = static_cast<float>(Bumps(column, rows - 1 - row));
    ASSERT_EQ(dataset->GetRasterBand(1)->RasterIO(GF_Write, 0, row, columns, 1, line.data(), columns, 1,
                                                  GDT_Float32, 0, 0),
              CE_None);
  }
  GDALClose(dataset);
}

class ElevationGrid : public ::testing::Test {
 protected:
  std::shared_ptr<const Scene> Load(const std::string& grid_keys) const {
    return Scene::Load(folder.Write("world.yaml", GridWorld(grid_keys)));
  }
  const TestFolder folder;
};

TEST_F(ElevationGrid, CropTakesTheRightCells) {
  folder.WriteGrid("g.asc", 16, 13, 10.0, Bumps);
  const auto scene = Load("    file: g.asc\n    offset_m: [30, 20]\n");
  // Nodes on cell centres carry the cells' heights, over a common lowest level.
  const double level = Bumps(3, 2) - scene->Ground().HeightAt(0, 0);
  for (int column = 0; column <= 10; ++column)
    for (int row = 0; row <= 8; ++row)
      EXPECT_NEAR(scene->Ground().HeightAt(10.0 * column, 10.0 * row), Bumps(column + 3, row + 2) - level,
                  1e-4)
          << column << " " << row;
  const auto& heights = scene->Ground().height_m;
  EXPECT_EQ(*std::min_element(heights.begin(), heights.end()), 0.0f);
}

TEST_F(ElevationGrid, ResamplingKeepsPlanesExactly) {
  // Interpolation of any order reproduces a plane, also next to the crop's edge.
  folder.WriteGrid("g.asc", 11, 9, 10.0, [](int column, int row) { return 5.0 + 2.0 * column + 3.0 * row; });
  const auto scene = Load("    file: g.asc\n");
  for (double x = 0.0; x <= 100.0; x += 2.0)
    for (double y = 0.0; y <= 80.0; y += 2.0)
      ASSERT_NEAR(scene->Ground().HeightAt(x, y), 0.2 * x + 0.3 * y, 1e-4) << x << " " << y;
}

TEST_F(ElevationGrid, ResamplingIsSmoothBetweenCells) {
  // A parabola: Catmull-Rom is exact away from the edge, bilinear interpolation would be 0.125 off.
  folder.WriteGrid("g.asc", 11, 9, 10.0, [](int column, int) { return 0.5 * (column - 5) * (column - 5); });
  const auto scene = Load("    file: g.asc\n");
  for (double x = 20.0; x <= 80.0; x += 2.0)
    ASSERT_NEAR(scene->Ground().HeightAt(x, 40.0), 0.005 * (x - 50.0) * (x - 50.0), 1e-4) << x;
}

TEST_F(ElevationGrid, ScalesLengthsAndHeights) {
  folder.WriteGrid("g.asc", 16, 13, 10.0, Bumps);
  const auto plain = Load("    file: g.asc\n    offset_m: [30, 20]\n    extent_m: [100, 80]\n");
  const auto half =
      Load("    file: g.asc\n    offset_m: [30, 20]\n    extent_m: [50, 40]\n    height_scale: 0.5\n");
  const double level =
      0.5 * plain->Ground().HeightAt(0, 0) - half->Ground().HeightAt(0, 0);  // another lowest point
  for (double x = 0.0; x <= 100.0; x += 20.0)
    for (double y = 0.0; y <= 80.0; y += 20.0)
      EXPECT_NEAR(half->Ground().HeightAt(x, y), 0.5 * plain->Ground().HeightAt(x / 2, y / 2) - level, 1e-4);
}

TEST_F(ElevationGrid, AsciiGridAndGeoTiffAgree) {
  folder.WriteGrid("g.asc", 16, 13, 10.0, Bumps);
  WriteTiff(folder.Path("g.tif"), 16, 13, 10.0);
  const auto ascii = Load("    file: g.asc\n    offset_m: [25, 13]\n");
  const auto tiff = Load("    file: g.tif\n    offset_m: [25, 13]\n");
  EXPECT_EQ(ascii->Ground().height_m, tiff->Ground().height_m);
  EXPECT_EQ(ascii->Fingerprint(), tiff->Fingerprint());
}

TEST_F(ElevationGrid, HolesOutsideTheCropDoNotMatter) {
  folder.WriteGrid("g.asc", 13, 9, 10.0,
                   [](int column, int row) { return column == 11 ? -9999.0 : Bumps(column, row); });
  EXPECT_NO_THROW(Load("    file: g.asc\n"));
}

}  // namespace
}  // namespace ed3r::world
