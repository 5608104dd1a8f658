// The files beside a raster that GDAL reads with it because they are called alike.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::world {

// What is wrong with them, "" for nothing: a pipe, which would be waited for; an .aux.xml that GDAL would pass over
// without a word, and so its units, scale and coordinate system. GDAL must be quiet.
std::string WhyNeighboursCannotBeRead(const std::filesystem::path& file);

// The name under which a raster has everything that stands beside it. A symbolic link has two such places, beside the
// link and beside the file that it leads to; `problem`, "" for none: they contradict each other, or each has a part.
struct RasterName {
  std::filesystem::path file;  // absolute
  std::string problem;
};
RasterName NameWithNeighbours(const std::filesystem::path& file);

// The mask beside it, whatever the case of its ending, or "".
std::string MaskBeside(const std::filesystem::path& file);

// Whether what is called so tells a unit: "altunits", "VERTICAL_UNIT", but not "community", nor that of
// TIFFTAG_RESOLUTIONUNIT.
bool IsCalledUnit(std::string_view name);

// What its metadata beside it, which GDAL does not read, says of units of length: what stands in elements or keys called
// unit, units, altunits and the like, and in vertical systems. Of a link, beside all that it leads to, too.
struct MetadataUnit {
  std::string file, text;  // "g.tif.xml", "US survey feet"
};
std::vector<MetadataUnit> UnitsOfMetadata(const std::filesystem::path& file);

}  // namespace ed3r::world
