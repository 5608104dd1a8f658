#include "engine/perception/render/develop.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/render/light.h"

namespace ed3r::perception {
namespace {

// Weights of the four pixels around a sampling point, times the exposure.
struct Taps {
  float w00, w01, w10, w11;
};

// The sum of four bytes of a hash, less its mean, has this standard deviation.
constexpr float kByteSumDeviation = 147.8f;

// One channel of one row. Plain loops over floats and 32-bit integers: the compiler makes vectors of them, and since
// nothing is fused or reordered, every instruction set gives the same bytes.
__attribute__((always_inline)) inline void DevelopRow(const float* upper, const float* lower, int width,
                                                      const Taps& taps, float noise_scale, std::uint32_t key,
                                                      std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const float radiance =
        (taps.w00 * upper[x] + taps.w01 * upper[x + 1]) + (taps.w10 * lower[x] + taps.w11 * lower[x + 1]);
    const float squeezed = radiance * (1.0f + radiance * (1.0f / 9.0f)) / (1.0f + radiance);
    std::uint32_t bits = (static_cast<std::uint32_t>(x) * 0x9e3779b1U) ^ key;
    bits = (bits ^ (bits >> 15)) * 0x2c1b3c6dU;
    bits = (bits ^ (bits >> 12)) * 0x297a2d39U;
    bits ^= bits >> 15;
    const int bytes =
        static_cast<int>((bits & 0xff) + ((bits >> 8) & 0xff) + ((bits >> 16) & 0xff) + (bits >> 24));
    const float level = 255.0f * std::sqrt(squeezed) + noise_scale * static_cast<float>(bytes - 510) + 0.5f;
    out[x] = static_cast<std::uint8_t>(static_cast<int>(std::min(255.0f, std::max(0.0f, level))));
  }
}

using RowFunction = void (*)(const float*, const float*, int, const Taps&, float, std::uint32_t,
                             std::uint8_t*);

void DevelopRowBaseline(const float* upper, const float* lower, int width, const Taps& taps,
                        float noise_scale, std::uint32_t key, std::uint8_t* out) {
  DevelopRow(upper, lower, width, taps, noise_scale, key, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void DevelopRowAvx2(const float* upper, const float* lower, int width,
                                                    const Taps& taps, float noise_scale, std::uint32_t key,
                                                    std::uint8_t* out) {
  DevelopRow(upper, lower, width, taps, noise_scale, key, out);
}
#endif

RowFunction ChooseRowFunction() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return DevelopRowAvx2;
#endif
  return DevelopRowBaseline;
}

}  // namespace

void Develop(const RadiancePlanes& radiance, const PixelGrid& grid, const Shot& shot,
             std::span<std::uint8_t> rgb) {
  static const RowFunction develop_row = ChooseRowFunction();
  ED3R_CHECK(rgb.size() == static_cast<std::size_t>(grid.width_px) * grid.height_px * 3, "size of the frame");
  const int right = static_cast<int>(std::floor(shot.right_px)),
            down = static_cast<int>(std::floor(shot.down_px));
  ED3R_CHECK(std::max({-right, -down, right + 1, down + 1}) <= grid.margin_px, "a shift beyond the margin");
  const float fx = shot.right_px - static_cast<float>(right), fy = shot.down_px - static_cast<float>(down);
  const float gain = shot.exposure;
  const Taps taps{gain * (1 - fx) * (1 - fy), gain * fx * (1 - fy), gain * (1 - fx) * fy, gain * fx * fy};
  const float noise_scale = shot.noise / kByteSumDeviation;
  const int width = grid.width_px;
  std::vector<std::uint8_t> planes(static_cast<std::size_t>(width) * 3);
  const float* channels[] = {radiance.red.data(), radiance.green.data(), radiance.blue.data()};
  for (int row = 0; row < grid.height_px; ++row) {
    const std::size_t start =
        static_cast<std::size_t>(row + grid.margin_px + down) * grid.Columns() + grid.margin_px + right;
    for (std::uint32_t channel = 0; channel < 3; ++channel) {
      const std::uint32_t key = Scramble(shot.noise_key + 3 * static_cast<std::uint32_t>(row) + channel);
      develop_row(channels[channel] + start, channels[channel] + start + grid.Columns(), width, taps,
                  noise_scale, key, planes.data() + channel * static_cast<std::size_t>(width));
    }
    std::uint8_t* out = rgb.data() + static_cast<std::size_t>(row) * width * 3;
    const std::uint8_t *red = planes.data(), *green = red + width, *blue = green + width;
    for (int x = 0; x < width; ++x) {
      out[3 * x] = red[x];
      out[3 * x + 1] = green[x];
      out[3 * x + 2] = blue[x];
    }
  }
}

}  // namespace ed3r::perception
