// The UTM zone of a place: a projection whose metres are true within 1 part in 1000 around there.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace ed3r::world {

// "EPSG:32610" on WGS 84; near the poles the polar stereographic one.
inline std::string UtmZone(double longitude_deg, double latitude_deg) {
  if (latitude_deg >= 84.0) return "EPSG:32661";
  if (latitude_deg <= -80.0) return "EPSG:32761";
  if (!(longitude_deg >= -180.0 && longitude_deg < 180.0))
    longitude_deg = std::remainder(longitude_deg, 360.0);
  if (!std::isfinite(longitude_deg)) longitude_deg = 0.0;
  const int zone = std::clamp(static_cast<int>(std::floor((longitude_deg + 180.0) / 6.0)) + 1, 1, 60);
  return fmt::format("EPSG:{}", (latitude_deg < 0.0 ? 32700 : 32600) + zone);
}

}  // namespace ed3r::world
