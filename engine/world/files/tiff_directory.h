// What the first directory of a TIFF says, from the file itself. The numbers among a GeoTIFF's keys: GDAL passes over the units of a coordinate system that it
// does not know, and over that of heights beside a vertical system that has one of its own.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace ed3r::world {

// By their numbers in the GeoTIFF standard; those of the first image. Empty: no TIFF, or one without keys.
std::map<int, int> ReadGeoKeys(const std::filesystem::path& file);

// Why not all blocks of heights can be as they are said to be: over each other, over the directory or the values of its tags; or
// more, fewer, longer or shorter than the grid's sides make them. One bit of these numbers would give other heights, of which
// GDAL says nothing. "" where nothing speaks against it.
std::string WhyBlocksDoNotFit(const std::filesystem::path& file);

inline constexpr int kProjectedUnitsKey = 3076;
inline constexpr int kVerticalUnitsKey = 4099;

// The unit of a key in words that FindLengthUnit knows, "EPSG unit 9005" for others; "" where the key is not there, or
// says that the unit is defined elsewhere.
std::string UnitOfKey(const std::map<int, int>& keys, int key);

}  // namespace ed3r::world
