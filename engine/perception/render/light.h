// Small arithmetic of light. Only + - * / and sqrt, so that a picture has the same bytes on every machine.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

namespace ed3r::perception {

// Linear radiance; 1 is a white wall in full sun.
using Colour = Eigen::Array3f;

// exp(-x) for x >= 0 within 1 % of the largest value: (1 - x/64)^64.
inline float Attenuation(float x) {
  float y = std::max(0.0f, 1.0f - x * (1.0f / 64.0f));
  y *= y;
  y *= y;
  y *= y;
  y *= y;
  y *= y;
  return y * y;
}

inline float SmoothStep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

inline Colour Mix(const Colour& a, const Colour& b, float share) { return a + (b - a) * share; }

// Well-mixed bits of an integer; for variety from object to object and for dither, not for statistics.
inline std::uint32_t Scramble(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}
inline float UnitOf(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }  // [0, 1)

}  // namespace ed3r::perception
