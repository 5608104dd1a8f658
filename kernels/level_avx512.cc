// AVX-512 level (compiled with -mavx512f -mavx2 -mfma).
#include <immintrin.h>

#include "kernels/avx_transpose.h"
#include "kernels/dense_kernels.h"

namespace ed3r {
namespace {

struct V {
  using F = __m512;
  static constexpr int kLanes = 16;
  // Zen 4 share of the FMA peak over 1000 candidates: 4 x 3 0.96, 16 x 1 0.94, 8 x 2 0.93, 8 x 3 0.90.
  static constexpr int kTileOutputs = 4, kTileVectors = 3;
  static constexpr int kGemmRows = 8, kGemmVectors = 16;

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

  // As in level_scalar.h.
  static F Dropout(F x, std::uint32_t counter, const DropoutDraws& draws) {
    const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    __m512i h = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(counter)), lanes);
    h = _mm512_xor_si512(h, _mm512_set1_epi32(static_cast<int>(draws.key0)));
    h = _mm512_mullo_epi32(_mm512_xor_si512(h, _mm512_srli_epi32(h, 16)), _mm512_set1_epi32(0x7feb352d));
    h = _mm512_xor_si512(h, _mm512_set1_epi32(static_cast<int>(draws.key1)));
    h = _mm512_mullo_epi32(_mm512_xor_si512(h, _mm512_srli_epi32(h, 15)),
                           _mm512_set1_epi32(static_cast<int>(0x846ca68bu)));
    h = _mm512_xor_si512(h, _mm512_srli_epi32(h, 16));
    const __m512i limit = _mm512_set1_epi32(static_cast<int>(draws.threshold));
    return _mm512_maskz_mov_ps(_mm512_cmple_epi32_mask(limit, _mm512_srli_epi32(h, 1)), x);
  }

  static void Transpose(const float* from, float* to) { TransposeBlock(from, to); }
};

}  // namespace
}  // namespace ed3r

#include "kernels/rfnn_loops.h"
#include "kernels/train_loops.h"

namespace ed3r {

const DenseKernels& Avx512Kernels() {
  static constexpr DenseKernels kKernels{AcrossCandidates, AcrossNeurons, BlockGradient, AdamBlock};
  return kKernels;
}

}  // namespace ed3r
