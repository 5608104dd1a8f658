// What a raster says of its lengths and heights: its coordinate system (in the file, or in a .prj beside it), the unit of
// its band, and the world file's words where the file has none.
#pragma once

#include <filesystem>
#include <string>

#include "engine/world/files/grid_spec.h"
#include "engine/world/files/length_unit.h"

class GDALDataset;
class OGRSpatialReference;

namespace ed3r::world {

struct RasterUnits {
  LengthUnit length{1.0, "m"}, height{1.0, "m"};
  std::string prj_file;  // that told of the coordinate system; "" where none was needed
};

// Refuses by UserError at the world file's key, with the command that mends it: degrees and radians, Web Mercator and
// every projection whose metre is not one on the ground there (within kMaxScaleError), a unit that is not known, units
// that contradict each other, heights whose unit nobody tells where lengths are not in metres.
// `own`: the coordinate system that a GeoTIFF has itself, where an .aux.xml beside it may have replaced it, or none.
// GDAL's errors must be silenced by the caller.
inline constexpr double kMaxScaleError =
    0.02;  // LAEA Europe and the US' Albers stay below it, Lambert Europe does not
RasterUnits UnitsOf(GDALDataset& dataset, const OGRSpatialReference* own, const std::filesystem::path& file,
                    const GridTerrainSpec& spec);

// The .prj beside a raster, whatever the case of its ending, or "".
std::string PrjBeside(const std::filesystem::path& file);

}  // namespace ed3r::world
