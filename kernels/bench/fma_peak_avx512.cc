#include <immintrin.h>

#include "kernels/bench/fma_peak.h"

namespace ed3r::bench {
namespace {

struct V {
  using F = __m512;
  static constexpr int kLanes = 16;
  static F Set1(float v) { return _mm512_set1_ps(v); }
  static F Fma(F a, F b, F c) { return _mm512_fmadd_ps(a, b, c); }
};

}  // namespace
}  // namespace ed3r::bench

#include "kernels/bench/fma_peak_loop.h"

namespace ed3r::bench {

double RunFmaPeakAvx512() { return FmaPeakLoop(); }

}  // namespace ed3r::bench
