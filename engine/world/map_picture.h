// A scene seen from above, for people: relief, trees, fire sites, base stations, start area.
#pragma once

#include <string>

#include "engine/world/scene.h"

namespace ed3r {

// Writes a picture of the given width; the file's ending chooses the format (.png, .jpg). Throws UserError
// when the file cannot be written.
void WriteMapPicture(const Scene& scene, const std::string& path, int width_px = 1200);

}  // namespace ed3r
