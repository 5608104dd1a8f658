// Internal: 16 x 16 floats transposed in four quarters of 8 x 8, for the AVX levels.
#pragma once

#include <immintrin.h>

#include <cstddef>

namespace ed3r::kernels {
namespace {

inline void TransposeQuarter(const float* from, float* to) {
  constexpr std::size_t kRow = 16;
  __m256 r[8], t[8];
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) r[i] = _mm256_loadu_ps(from + i * kRow);
#pragma GCC unroll 4
  for (int i = 0; i < 8; i += 2) {
    t[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
    t[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
  }
#pragma GCC unroll 2
  for (int i = 0; i < 8; i += 4) {
    r[i] = _mm256_shuffle_ps(t[i], t[i + 2], 0x44);
    r[i + 1] = _mm256_shuffle_ps(t[i], t[i + 2], 0xee);
    r[i + 2] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0x44);
    r[i + 3] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0xee);
  }
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    _mm256_storeu_ps(to + i * kRow, _mm256_permute2f128_ps(r[i], r[i + 4], 0x20));
    _mm256_storeu_ps(to + (i + 4) * kRow, _mm256_permute2f128_ps(r[i], r[i + 4], 0x31));
  }
}

inline void TransposeBlock(const float* from, float* to) {
  for (int row = 0; row < 16; row += 8)
    for (int column = 0; column < 16; column += 8)
      TransposeQuarter(from + row * 16 + column, to + column * 16 + row);
}

}  // namespace
}  // namespace ed3r::kernels
