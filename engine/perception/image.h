// Camera frames as the detectors take them.
#pragma once

#include <cstdint>
#include <vector>

namespace ed3r::perception {

// The frames of one sensing period, frame after frame; rows top to bottom, pixels left to right, red, green and
// blue interleaved, 8 bits each, display-encoded: frames * height_px * width_px * 3 bytes.
struct FrameStack {
  int frames = 0;
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace ed3r::perception
