// Internal: the scalar twin. Included by level_scalar.cc and level_scalar_fma.cc, which differ in one
// compiler flag.
#pragma once

namespace ed3r {
namespace {

struct V {
  using F = float;
  static constexpr int kLanes = 1;
  static constexpr int kTileOutputs = 4, kTileVectors = 3;
  static constexpr int kGemmRows = 2, kGemmVectors = 16;

  static F Load(const float* p) { return *p; }
  static void Store(float* p, F v) { *p = v; }
  static F Set1(float v) { return v; }
  static F Fma(F a, F b, F c) { return __builtin_fmaf(a, b, c); }
  static F Relu(F z) { return 0.0f > z ? 0.0f : z; }
};

}  // namespace
}  // namespace ed3r
