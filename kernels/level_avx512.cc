// AVX-512 level (compiled with -mavx512f -mavx2 -mfma).
#include <immintrin.h>

#include "kernels/avx_transpose.h"
#include "kernels/dense_kernels.h"

namespace ed3r::kernels {
namespace {

struct V {
  using F = __m512;
  static constexpr int kLanes = 16;
  // Training step on Zen 4, rows x blocks, gradient part: 4 x 4 114.5 us, 2 x 4 114.8, 5 x 4 116.6, 8 x 2
  // 117.5, 6 x 4 118.0, 12 x 2 122.1. Blocks before rows in the outer loop: no difference.
  static constexpr int kGemmRows = 4, kGemmVectors = 16;

  static F Load(const float* p) { return _mm512_loadu_ps(p); }
  static void Store(float* p, F v) { _mm512_storeu_ps(p, v); }
  static F Set1(float v) { return _mm512_set1_ps(v); }
  // Keeps a load out of the FMAs that use it: GCC folds it into each, and 64-byte loads become the
  // bottleneck.
  static F Held(F v) {
    asm("" : "+v"(v));
    return v;
  }
  static F Fma(F a, F b, F c) { return _mm512_fmadd_ps(a, b, c); }
  static F FusedNegative(F a, F b, F c) { return _mm512_fnmadd_ps(a, b, c); }
  static F Add(F a, F b) { return _mm512_add_ps(a, b); }
  static F Mul(F a, F b) { return _mm512_mul_ps(a, b); }
  static F Div(F a, F b) { return _mm512_div_ps(a, b); }
  static F Sqrt(F v) { return _mm512_sqrt_ps(v); }
  // maxps returns its second operand for a NaN or two zeros: 0 > z ? 0 : z.
  static F Relu(F z) { return _mm512_max_ps(_mm512_setzero_ps(), z); }
  static F WherePositive(F h, F x) {
    return _mm512_maskz_mov_ps(_mm512_cmp_ps_mask(h, _mm512_setzero_ps(), _CMP_GT_OQ), x);
  }

  static F Dropout(F x, std::uint32_t row_key, const std::uint32_t* neuron_keys, std::int32_t limit) {
    const __m512i y =
        _mm512_xor_si512(_mm512_set1_epi32(static_cast<int>(row_key)), _mm512_loadu_si512(neuron_keys));
    const __m512i z = _mm512_mullo_epi32(_mm512_xor_si512(y, _mm512_srli_epi32(y, 15)),
                                         _mm512_set1_epi32(static_cast<int>(0x846ca68bu)));
    return _mm512_maskz_mov_ps(_mm512_cmpge_epi32_mask(z, _mm512_set1_epi32(limit)), x);
  }

  static void Transpose(const float* from, float* to) { TransposeBlock(from, to); }
};

}  // namespace
}  // namespace ed3r::kernels

#include "kernels/rfnn_loops.h"
#include "kernels/train_loops.h"

namespace ed3r::kernels {

const DenseKernels& Avx512Kernels() {
  static constexpr DenseKernels kKernels{AcrossCandidates, AcrossNeurons, BlockGradient, AdamBlock};
  return kKernels;
}

}  // namespace ed3r::kernels
