#include "engine/perception/render/noise_volume.h"

#include <algorithm>
#include <array>

#include "engine/core/random.h"

namespace ed3r::perception {
namespace {

constexpr std::uint64_t kKey = 0x5eed0f7ab1e;
constexpr int kOctaves = 3;
constexpr float kContrast = 0.9f;  // stretches the octaves' sum, about [-0.55, 0.55], over the bytes

// The twelve edges of a cube: Perlin's gradients, free of any square root.
constexpr std::array<std::array<float, 3>, 12> kGradients = {{{1, 1, 0},
                                                              {-1, 1, 0},
                                                              {1, -1, 0},
                                                              {-1, -1, 0},
                                                              {1, 0, 1},
                                                              {-1, 0, 1},
                                                              {1, 0, -1},
                                                              {-1, 0, -1},
                                                              {0, 1, 1},
                                                              {0, -1, 1},
                                                              {0, 1, -1},
                                                              {0, -1, -1}}};

// Gradient noise on a lattice that repeats after `period` points.
class Lattice {
 public:
  Lattice(Stream& stream, int period)
      : period_(period), gradient_(static_cast<std::size_t>(period) * period * period) {
    for (std::uint8_t& g : gradient_) g = static_cast<std::uint8_t>(stream.Below(kGradients.size()));
  }

  float At(float x, float y, float z) const {
    const int ix = static_cast<int>(x), iy = static_cast<int>(y), iz = static_cast<int>(z);
    const float fx = x - ix, fy = y - iy, fz = z - iz;
    float sum = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
      const int cx = corner & 1, cy = (corner >> 1) & 1, cz = corner >> 2;
      const auto& g = kGradients[Gradient(ix + cx, iy + cy, iz + cz)];
      const float weight = Fade(cx ? 1 - fx : fx) * Fade(cy ? 1 - fy : fy) * Fade(cz ? 1 - fz : fz);
      sum += weight * (g[0] * (fx - cx) + g[1] * (fy - cy) + g[2] * (fz - cz));
    }
    return sum;
  }

 private:
  // 1 at the corner itself, 0 a lattice step away, smooth to the second derivative.
  static float Fade(float t) { return 1.0f - t * t * t * (t * (t * 6 - 15) + 10); }
  std::size_t Gradient(int x, int y, int z) const {
    return gradient_[(static_cast<std::size_t>(y % period_) * period_ + x % period_) * period_ + z % period_];
  }

  int period_;
  std::vector<std::uint8_t> gradient_;
};

}  // namespace

const NoiseVolume& NoiseVolume::Shared() {
  static const NoiseVolume volume;
  return volume;
}

NoiseVolume::NoiseVolume() : cells_(static_cast<std::size_t>(kCells) * kCells * kCells) {
  Stream stream(kKey, 0, Purpose::kRendering);
  std::vector<float> sum(cells_.size(), 0.0f);
  float weight = 1.0f;
  for (int octave = 0; octave < kOctaves; ++octave, weight *= 0.5f) {
    const int period = kPeriod << octave;
    const Lattice lattice(stream, period);
    const float step = static_cast<float>(period) / kCells;
    std::size_t i = 0;
    for (int y = 0; y < kCells; ++y)
      for (int x = 0; x < kCells; ++x)
        for (int z = 0; z < kCells; ++z)
          sum[i++] += weight * lattice.At((x + 0.5f) * step, (y + 0.5f) * step, (z + 0.5f) * step);
  }
  for (std::size_t i = 0; i < cells_.size(); ++i)
    cells_[i] = static_cast<std::uint8_t>(std::clamp(127.5f * (1.0f + kContrast * sum[i]), 0.0f, 255.0f));
}

float NoiseVolume::At(float x, float y, float z) const {
  const float cx = x * kCellsPerUnit - 0.5f, cy = y * kCellsPerUnit - 0.5f, cz = z * kCellsPerUnit - 0.5f;
  // Truncation towards zero of a shifted value: floor without a library call.
  constexpr int kShift = 1 << 24;
  const int ix = static_cast<int>(static_cast<double>(cx) + kShift) - kShift;
  const int iy = static_cast<int>(static_cast<double>(cy) + kShift) - kShift;
  const int iz = static_cast<int>(static_cast<double>(cz) + kShift) - kShift;
  const float fx = cx - ix, fy = cy - iy, fz = cz - iz;
  constexpr int kMask = kCells - 1;
  const int z0 = iz & kMask, z1 = (iz + 1) & kMask;
  const auto along_z = [&](const std::uint8_t* column) {
    return static_cast<float>(column[z0]) +
           fz * (static_cast<float>(column[z1]) - static_cast<float>(column[z0]));
  };
  const float a = along_z(Column(ix, iy)), b = along_z(Column(ix + 1, iy));
  const float c = along_z(Column(ix, iy + 1)), d = along_z(Column(ix + 1, iy + 1));
  const float south = a + fx * (b - a), north = c + fx * (d - c);
  return (south + fy * (north - south)) * (1.0f / 255.0f);
}

}  // namespace ed3r::perception
