#include "kernels/bench/fma_peak.h"

namespace ed3r::bench {
namespace {

struct V {
  using F = float;
  static constexpr int kLanes = 1;
  static F Set1(float v) { return v; }
  static F Fma(F a, F b, F c) { return __builtin_fmaf(a, b, c); }
};

}  // namespace
}  // namespace ed3r::bench

#include "kernels/bench/fma_peak_loop.h"

namespace ed3r::bench {

double RunFmaPeakScalar() { return FmaPeakLoop(); }

double RunFmaPeak(kernels::SimdLevel level) {
  if (level == kernels::SimdLevel::kAvx512) return RunFmaPeakAvx512();
  if (level == kernels::SimdLevel::kAvx2) return RunFmaPeakAvx2();
  return RunFmaPeakScalar();
}

}  // namespace ed3r::bench
