// The numbers among a GeoTIFF's keys, from the file itself: GDAL passes over the units of a coordinate system that it
// does not know, and over that of heights beside a vertical system that has one of its own.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace ed3r::world {

// By their numbers in the GeoTIFF standard; those of the first image. Empty: no TIFF, or one without keys.
std::map<int, int> ReadGeoKeys(const std::filesystem::path& file);

inline constexpr int kProjectedUnitsKey = 3076;
inline constexpr int kVerticalUnitsKey = 4099;

// The unit of a key in words that FindLengthUnit knows, "EPSG unit 9005" for others; "" where the key is not there, or
// says that the unit is defined elsewhere.
std::string UnitOfKey(const std::map<int, int>& keys, int key);

}  // namespace ed3r::world
