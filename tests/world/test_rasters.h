// GeoTIFFs that a test writes for itself with GDAL, and what a world makes of them.
#pragma once

#include <fmt/format.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/world/scene.h"
#include "engine/world/terrain.h"
#include "tests/world/world_files.h"

namespace ed3r::world {

struct TestRaster {
  int columns = 11, rows = 9;
  double cell = 10.0, west = 500000.0, south = 4000000.0;  // in the unit of the coordinate system
  GDALDataType type = GDT_Float32;
  std::function<double(int, int)> stored = [](int, int) {
    return 5.0;
  };                   // by column, and by row from the south
  std::string system;  // what OGRSpatialReference understands, "" for none
  std::string unit;    // of the band
  std::string name;    // of the band
  std::optional<double> scale, offset, no_data;
  std::function<bool(int, int)> masked;       // cells that the internal mask leaves out
  std::function<bool(int, int)> transparent;  // by an alpha band
};

inline void WriteRows(GDALRasterBand& band, const TestRaster& raster,
                      const std::function<double(int, int)>& value) {
  std::vector<double> line(static_cast<std::size_t>(raster.columns));
  for (int row = 0; row < raster.rows; ++row) {
    for (int column = 0; column < raster.columns; ++column)
      line[static_cast<std::size_t>(column)] = value(column, raster.rows - 1 - row);
    ASSERT_EQ(
        band.RasterIO(GF_Write, 0, row, raster.columns, 1, line.data(), raster.columns, 1, GDT_Float64, 0, 0),
        CE_None);
  }
}

inline void WriteRaster(const std::string& path, const TestRaster& raster) {
  GDALRegister_GTiff();
  CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDataset* dataset = driver->Create(path.c_str(), raster.columns, raster.rows, raster.transparent ? 2 : 1,
                                        raster.type, nullptr);
  ASSERT_NE(dataset, nullptr);
  double transform[6] = {raster.west, raster.cell, 0.0, raster.south + raster.rows * raster.cell,
                         0.0,         -raster.cell};
  dataset->SetGeoTransform(transform);
  if (!raster.system.empty()) {
    OGRSpatialReference system;
    ASSERT_EQ(system.SetFromUserInput(raster.system.c_str()), OGRERR_NONE) << raster.system;
    dataset->SetSpatialRef(&system);
  }
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  if (raster.no_data) band.SetNoDataValue(*raster.no_data);
  if (raster.scale) band.SetScale(*raster.scale);
  if (raster.offset) band.SetOffset(*raster.offset);
  if (!raster.unit.empty()) band.SetUnitType(raster.unit.c_str());
  if (!raster.name.empty()) band.SetDescription(raster.name.c_str());
  if (raster.transparent) dataset->GetRasterBand(2)->SetColorInterpretation(GCI_AlphaBand);
  if (raster.masked) {
    ASSERT_EQ(dataset->CreateMaskBand(GMF_PER_DATASET), CE_None);
    WriteRows(*band.GetMaskBand(), raster, [&](int x, int y) { return raster.masked(x, y) ? 0.0 : 255.0; });
  }
  WriteRows(band, raster, raster.stored);
  if (raster.transparent)
    WriteRows(*dataset->GetRasterBand(2), raster,
              [&](int x, int y) { return raster.transparent(x, y) ? 0.0 : 255.0; });
  GDALClose(dataset);
  CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
}

// The height of the ground at [100, 80] m on a grid of the folder, or what was said of the file.
inline std::string HeightOrProblem(const TestFolder& folder, const std::string& file) {
  try {
    const auto scene = Scene::Load(folder.Write("w.yaml", GridWorld(fmt::format("    file: {}\n", file))));
    return fmt::format("{:.2f}", scene->Ground().HeightAt(100.0, 80.0));
  } catch (const UserError& error) {
    const std::string prefix = folder.Path(""), begin = "w.yaml:6:11: terrain.grid.file: ";
    std::string text = error.what();
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text.starts_with(begin) ? text.substr(begin.size()) : text;
  }
}

}  // namespace ed3r::world
