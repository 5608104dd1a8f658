#include "engine/world/noise.h"

#include <cmath>
#include <utility>

namespace ed3r::world {
namespace {

struct Gradient {
  double x, y;
};

constexpr double kA = 0.92387953251128674;  // cos and sin of 22.5 degrees
constexpr double kB = 0.38268343236508977;
constexpr double kC = 0.70710678118654752;
constexpr Gradient kGradients[16] = {{1, 0},    {kA, kB},  {kC, kC},  {kB, kA},   {0, 1},     {-kB, kA},
                                     {-kC, kC}, {-kA, kB}, {-1, 0},   {-kA, -kB}, {-kC, -kC}, {-kB, -kA},
                                     {0, -1},   {kB, -kA}, {kC, -kC}, {kA, -kB}};

double Fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }

double Blend(double a, double b, double t) { return a + t * (b - a); }

}  // namespace

GradientNoise::GradientNoise(Stream& stream) {
  for (int i = 0; i < 256; ++i) order_[i] = static_cast<std::uint8_t>(i);
  for (int i = 255; i > 0; --i) std::swap(order_[i], order_[stream.Below(i + 1)]);
}

double GradientNoise::At(double x, double y) const {
  const double floor_x = std::floor(x);
  const double floor_y = std::floor(y);
  const int column = static_cast<int>(static_cast<std::int64_t>(floor_x) & 255);
  const int row = static_cast<int>(static_cast<std::int64_t>(floor_y) & 255);
  const auto corner = [&](int right, int up) {
    const int hash = order_[(order_[(column + right) & 255] + row + up) & 255];
    const Gradient& g = kGradients[hash & 15];
    return g.x * (x - floor_x - right) + g.y * (y - floor_y - up);
  };
  const double u = Fade(x - floor_x);
  const double v = Fade(y - floor_y);
  // A gradient of length 1 reaches sqrt(1/2) at most.
  return 1.4142135623730951 *
         Blend(Blend(corner(0, 0), corner(1, 0), u), Blend(corner(0, 1), corner(1, 1), u), v);
}

double GradientNoise::Fractal(double x, double y, int octaves, double gain) const {
  double sum = 0.0;
  double weights = 0.0;
  double weight = 1.0;
  double size = 1.0;
  for (int octave = 0; octave < octaves; ++octave) {
    // Shifted, so that the zeros of the octaves do not coincide.
    sum += weight * At(x * size + 17.31 * octave, y * size + 41.77 * octave);
    weights += weight;
    weight *= gain;
    size *= 2.0;
  }
  return sum / weights;
}

}  // namespace ed3r::world
