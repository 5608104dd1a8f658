// A scene seen from above, for people: relief, trees, fire sites, base stations, start area.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/world/scene.h"

namespace ed3r::world {

// One mission drawn over the map.
struct MapOverlay {
  std::vector<Eigen::Vector3d> path_m;  // positions after each timestep, the start first; empty draws none
  int site = -1;                        // the only fire that burns; -1 draws all sites
};

// Writes a picture of the given width; the file's ending chooses the format (.png, .jpg). Throws UserError
// when the file cannot be written.
void WriteMapPicture(const Scene& scene, const std::string& path, const MapOverlay& overlay = {},
                     int width_px = 1200);

}  // namespace ed3r::world
