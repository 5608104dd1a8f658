// Internal: the scalar twin. Included by level_scalar.cc and level_scalar_fma.cc, which differ in one
// compiler flag.
#pragma once

#include <cstdint>

#include "kernels/dense_kernels.h"

namespace ed3r::kernels {
namespace {

struct V {
  using F = float;
  static constexpr int kLanes = 1;
  static constexpr int kGemmRows = 2, kGemmVectors = 16;

  static F Load(const float* p) { return *p; }
  static void Store(float* p, F v) { *p = v; }
  static F Set1(float v) { return v; }
  static F Held(F v) { return v; }
  static F Fma(F a, F b, F c) { return __builtin_fmaf(a, b, c); }
  static F FusedNegative(F a, F b, F c) { return __builtin_fmaf(-a, b, c); }
  static F Add(F a, F b) { return a + b; }
  static F Mul(F a, F b) { return a * b; }
  static F Div(F a, F b) { return a / b; }
  static F Sqrt(F v) { return __builtin_sqrtf(v); }
  static F Relu(F z) { return 0.0f > z ? 0.0f : z; }
  static F WherePositive(F h, F x) { return h > 0.0f ? x : 0.0f; }

  static F Dropout(F x, std::uint32_t row_key, const std::uint32_t* neuron_keys, std::int32_t limit) {
    const std::uint32_t y = row_key ^ *neuron_keys;
    return static_cast<std::int32_t>((y ^ (y >> 15)) * 0x846ca68bu) < limit ? 0.0f : x;
  }

  static void Transpose(const float* from, float* to) {
    for (int row = 0; row < 16; ++row)
      for (int column = 0; column < 16; ++column) to[column * 16 + row] = from[row * 16 + column];
  }
};

}  // namespace
}  // namespace ed3r::kernels
