// AVX2 + FMA level (compiled with -mavx2 -mfma).
#include <immintrin.h>

#include "kernels/avx_transpose.h"
#include "kernels/dense_kernels.h"

namespace ed3r::kernels {
namespace {

struct V {
  using F = __m256;
  static constexpr int kLanes = 8;
  static constexpr int kGemmRows = 6, kGemmVectors = 12;

  static F Load(const float* p) { return _mm256_loadu_ps(p); }
  static void Store(float* p, F v) { _mm256_storeu_ps(p, v); }
  static F Set1(float v) { return _mm256_set1_ps(v); }
  static F Held(F v) { return v; }
  static F Fma(F a, F b, F c) { return _mm256_fmadd_ps(a, b, c); }
  static F FusedNegative(F a, F b, F c) { return _mm256_fnmadd_ps(a, b, c); }
  static F Add(F a, F b) { return _mm256_add_ps(a, b); }
  static F Mul(F a, F b) { return _mm256_mul_ps(a, b); }
  static F Div(F a, F b) { return _mm256_div_ps(a, b); }
  static F Sqrt(F v) { return _mm256_sqrt_ps(v); }
  // maxps returns its second operand for a NaN or two zeros: 0 > z ? 0 : z.
  static F Relu(F z) { return _mm256_max_ps(_mm256_setzero_ps(), z); }
  static F WherePositive(F h, F x) {
    return _mm256_and_ps(_mm256_cmp_ps(h, _mm256_setzero_ps(), _CMP_GT_OQ), x);
  }

  static F Dropout(F x, std::uint32_t row_key, const std::uint32_t* neuron_keys, std::int32_t limit) {
    const __m256i y = _mm256_xor_si256(_mm256_set1_epi32(static_cast<int>(row_key)),
                                       _mm256_loadu_si256(reinterpret_cast<const __m256i*>(neuron_keys)));
    const __m256i z = _mm256_mullo_epi32(_mm256_xor_si256(y, _mm256_srli_epi32(y, 15)),
                                         _mm256_set1_epi32(static_cast<int>(0x846ca68bu)));
    return _mm256_andnot_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(_mm256_set1_epi32(limit), z)), x);
  }

  static void Transpose(const float* from, float* to) { TransposeBlock(from, to); }
};

}  // namespace
}  // namespace ed3r::kernels

#include "kernels/rfnn_loops.h"
#include "kernels/train_loops.h"

namespace ed3r::kernels {

const DenseKernels& Avx2Kernels() {
  static constexpr DenseKernels kKernels{AcrossCandidates, AcrossNeurons, BlockGradient, AdamBlock};
  return kKernels;
}

}  // namespace ed3r::kernels
