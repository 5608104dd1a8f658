// From radiance to the bytes of a frame: sway of the camera, exposure, tone curve, sensor noise.
#pragma once

#include <cstdint>
#include <span>

#include "engine/perception/render/shade.h"
#include "engine/perception/render/trace.h"

namespace ed3r::perception {

// How one frame is taken.
struct Shot {
  float right_px = 0.0f,
        down_px = 0.0f;  // by how much the camera's sway moves the picture's origin; within the margin
  float exposure = 1.0f;
  float noise = 0.0f;  // standard deviation in 1/255
  std::uint32_t noise_key = 0;
};

// Writes height_px * width_px * 3 bytes. Radiance is sampled between its pixels (bilinear), multiplied by the
// exposure, squeezed by x (1 + x/9) / (1 + x), encoded with gamma 2 and given noise: photon noise is even in a
// square-root code. Errors: a shift that leaves the margin throws InternalError.
void Develop(const RadiancePlanes& radiance, const PixelGrid& grid, const Shot& shot,
             std::span<std::uint8_t> rgb);

}  // namespace ed3r::perception
