// A cube of turbulence that repeats in every direction: the texture of smoke, flames, clouds, leaves and ground.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ed3r::perception {

// Three octaves of gradient noise in kCells^3 bytes; the largest features have size 1, the period is kPeriod.
// Threads: immutable once built; every const member may be called from any thread.
class NoiseVolume {
 public:
  static constexpr int kCells = 64;
  static constexpr int kPeriod = 8;
  static constexpr float kCellsPerUnit = static_cast<float>(kCells) / kPeriod;

  // The one volume of the program: made from a fixed key on first use, the same on every machine.
  static const NoiseVolume& Shared();

  // Smooth (trilinear), in [0, 1], mean 0.5; any finite coordinates within +-1e6.
  float At(float x, float y, float z) const;

  // Nearest cell, by cell numbers of any sign; 0..255. z runs fastest in memory.
  std::uint8_t Cell(int x, int y, int z) const {
    constexpr int kMask = kCells - 1;
    return cells_[static_cast<std::size_t>((((y & kMask) * kCells) + (x & kMask)) * kCells + (z & kMask))];
  }
  // The kCells values along z over one (x, y); wrap z with kCells - 1.
  const std::uint8_t* Column(int x, int y) const {
    constexpr int kMask = kCells - 1;
    return cells_.data() + static_cast<std::size_t>((((y & kMask) * kCells) + (x & kMask)) * kCells);
  }

 private:
  NoiseVolume();
  std::vector<std::uint8_t> cells_;
};

}  // namespace ed3r::perception
