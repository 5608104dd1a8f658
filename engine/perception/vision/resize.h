// Frames in another size, for networks that want one.
#pragma once

#include "engine/perception/image.h"

namespace ed3r::perception {

// Each pixel of the result is the mean of the part of the picture that it covers, rounded half up: exact integer
// arithmetic, so the same on every CPU. Sides of 1 .. 20000 pixels. Proportions are not kept.
FrameStack Resized(const FrameStack& frames, int width_px, int height_px);

}  // namespace ed3r::perception
