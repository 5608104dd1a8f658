// Internal: what each SIMD level provides, and the arguments it is called with. Plain data only: this header
// is compiled once per instruction set, and an inline function here could reach callers that lack it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/dense_net.h"
#include "kernels/rfnn.h"
#include "kernels/simd_level.h"

namespace ed3r {

// Candidates of the widest tile (AVX-512: 3 vectors of 16).
inline constexpr int kMaxTile = 48;

struct DenseKernels {
  RfnnBest (*across_candidates)(const DenseNet& net, const RfnnDecision& decision, float* workspace);
  RfnnBest (*across_neurons)(const DenseNet& net, const RfnnDecision& decision, float* workspace);
};

const DenseKernels& ScalarKernels();     // std::fma by the C library: any CPU
const DenseKernels& ScalarFmaKernels();  // the same code where the CPU has the scalar instruction
const DenseKernels& Avx2Kernels();
const DenseKernels& Avx512Kernels();

// The kernels of a level. Throws SimdLevelError where this CPU lacks it.
const DenseKernels& KernelsFor(SimdLevel level);

}  // namespace ed3r
