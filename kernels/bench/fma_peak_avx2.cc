#include <immintrin.h>

#include "kernels/bench/fma_peak.h"

namespace ed3r::bench {
namespace {

struct V {
  using F = __m256;
  static constexpr int kLanes = 8;
  static F Set1(float v) { return _mm256_set1_ps(v); }
  static F Fma(F a, F b, F c) { return _mm256_fmadd_ps(a, b, c); }
};

}  // namespace
}  // namespace ed3r::bench

#include "kernels/bench/fma_peak_loop.h"

namespace ed3r::bench {

double RunFmaPeakAvx2() { return FmaPeakLoop(); }

}  // namespace ed3r::bench
