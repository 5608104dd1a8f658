// AVX2 + FMA level (compiled with -mavx2 -mfma).
#include <immintrin.h>

namespace ed3r {
namespace {

struct V {
  using F = __m256;
  static constexpr int kLanes = 8;
  // 16 registers: 12 sums, 3 inputs, 1 broadcast weight.
  static constexpr int kTileOutputs = 4, kTileVectors = 3;
  static constexpr int kGemmRows = 6, kGemmVectors = 12;

  static F Load(const float* p) { return _mm256_loadu_ps(p); }
  static void Store(float* p, F v) { _mm256_storeu_ps(p, v); }
  static F Set1(float v) { return _mm256_set1_ps(v); }
  static F Fma(F a, F b, F c) { return _mm256_fmadd_ps(a, b, c); }
  // maxps returns its second operand for a NaN or two zeros: 0 > z ? 0 : z.
  static F Relu(F z) { return _mm256_max_ps(_mm256_setzero_ps(), z); }
};

}  // namespace
}  // namespace ed3r

#include "kernels/rfnn_loops.h"

namespace ed3r {

const DenseKernels& Avx2Kernels() {
  static constexpr DenseKernels kKernels{AcrossCandidates, AcrossNeurons};
  return kKernels;
}

}  // namespace ed3r
