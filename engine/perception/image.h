// The camera's frames of one sensing period, as the renderer leaves them and the detectors take them.
#pragma once

#include <cstdint>
#include <vector>

namespace ed3r {

// Frame-major, rows from top to bottom, pixels from left to right, interleaved red, green, blue in 0 .. 255:
// rgb has frames * height_px * width_px * 3 bytes.
struct FrameStack {
  int frames = 0;
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace ed3r
