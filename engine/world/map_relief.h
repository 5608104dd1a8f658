// The ground of a map: hill-shaded relief in elevation colours, with contour lines.
#pragma once

#include <opencv2/core.hpp>

#include "engine/world/scene.h"

namespace ed3r::world {

// Colour (blue, green, red; 0 .. 255) of a share of the highest elevation.
cv::Vec3f ElevationColour(double share);

// Metres between contour lines, every fifth of them bold: about ten lines up to the highest ground.
double ContourStepM(double highest_m);

// North up, 8-bit BGR of the given size, for ground between 0 and highest_m.
cv::Mat DrawRelief(const Terrain& terrain, cv::Size size_px, double highest_m);

}  // namespace ed3r::world
