// Gradient noise for landscapes. Only + - * / and sqrt: the same bits on every machine, whatever the C
// library.
#pragma once

#include <array>
#include <cstdint>

#include "engine/core/random.h"

namespace ed3r::world {

// Smooth pseudo-random function of the plane, about [-1, 1], 0 on whole coordinates; features of size 1.
// Repeats after 256.
class GradientNoise {
 public:
  explicit GradientNoise(Stream& stream);

  double At(double x, double y) const;

  // Sum of octaves, each with half the size and `gain` times the weight of the one before; about [-1, 1].
  double Fractal(double x, double y, int octaves, double gain = 0.5) const;

 private:
  std::array<std::uint8_t, 256> order_;
};

}  // namespace ed3r::world
