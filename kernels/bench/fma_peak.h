// The most that a core can do: independent fused multiply-adds on registers only.
#pragma once

#include "kernels/simd_level.h"

namespace ed3r::bench {

// Runs the loop once, some ten microseconds, and returns the floating-point operations that it did.
double RunFmaPeak(kernels::SimdLevel level);

double RunFmaPeakScalar();
double RunFmaPeakAvx2();
double RunFmaPeakAvx512();

}  // namespace ed3r::bench
