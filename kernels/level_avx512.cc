// AVX-512 level (compiled with -mavx512f -mavx2 -mfma).
#include <immintrin.h>

namespace ed3r {
namespace {

struct V {
  using F = __m512;
  static constexpr int kLanes = 16;
  // 32 registers: 24 sums, 3 inputs, broadcast weights.
  static constexpr int kTileOutputs = 8, kTileVectors = 3;
  static constexpr int kGemmRows = 8, kGemmVectors = 16;

  static F Load(const float* p) { return _mm512_loadu_ps(p); }
  static void Store(float* p, F v) { _mm512_storeu_ps(p, v); }
  static F Set1(float v) { return _mm512_set1_ps(v); }
  static F Fma(F a, F b, F c) { return _mm512_fmadd_ps(a, b, c); }
  // maxps returns its second operand for a NaN or two zeros: 0 > z ? 0 : z.
  static F Relu(F z) { return _mm512_max_ps(_mm512_setzero_ps(), z); }
};

}  // namespace
}  // namespace ed3r

#include "kernels/rfnn_loops.h"

namespace ed3r {

const DenseKernels& Avx512Kernels() {
  static constexpr DenseKernels kKernels{AcrossCandidates, AcrossNeurons};
  return kKernels;
}

}  // namespace ed3r
