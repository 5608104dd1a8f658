// Internal: the loop, for a vector type V::F with V::Set1 and V::Fma. Included once per instruction set.
#pragma once

namespace ed3r::bench {
namespace {

double FmaPeakLoop() {
  constexpr int kSums = 12, kSteps = 4000;  // 12 independent sums hide the latency of every known core
  V::F sums[kSums];
#pragma GCC unroll 16
  for (int s = 0; s < kSums; ++s) sums[s] = V::Set1(1.0f + s);
  const V::F a = V::Set1(0.999f), b = V::Set1(0.001f);
  for (int step = 0; step < kSteps; ++step)
#pragma GCC unroll 16
    for (int s = 0; s < kSums; ++s) {
      sums[s] = V::Fma(sums[s], a, b);
      asm volatile("" : "+v"(sums[s]));  // neither hoisted nor dropped
    }
  return 2.0 * kSums * kSteps * V::kLanes;
}

}  // namespace
}  // namespace ed3r::bench
