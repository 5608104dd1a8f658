#include "kernels/rfnn.h"

#include <algorithm>
#include <string>

#include "kernels/dense_kernels.h"

namespace ed3r::kernels {

const DenseKernels& KernelsFor(SimdLevel level) {
  static const bool supported[] = {SimdLevelSupported(SimdLevel::kScalar),
                                   SimdLevelSupported(SimdLevel::kAvx2),
                                   SimdLevelSupported(SimdLevel::kAvx512)};
  if (!supported[static_cast<int>(level)])
    throw SimdLevelError(std::string("SIMD level ") + SimdLevelName(level) +
                         ": this CPU does not have it; it has: " + SupportedSimdLevels());
#ifdef ED3R_KERNELS_X86
  if (level == SimdLevel::kAvx512) return Avx512Kernels();
  if (level == SimdLevel::kAvx2) return Avx2Kernels();
  static const bool fma = __builtin_cpu_supports("fma");
  if (fma) return ScalarFmaKernels();
#endif
  return ScalarKernels();
}

std::size_t RfnnWorkspaceFloats(const DenseShape& shape) {
  const std::size_t aligning = 16;
  const std::size_t across_candidates = 1 + 3 * kMaxTile;  // state part, inputs, two layers
  const std::size_t across_neurons = 1 + 2 * kRfnnFew;     // state part, two layers
  return WidestLayer(shape) * std::max(across_candidates, across_neurons) + aligning;
}

RfnnBest RfnnAcrossCandidates(const DenseNet& net, const RfnnDecision& decision, float* workspace,
                              SimdLevel level) {
  return KernelsFor(level).across_candidates(net, decision, workspace);
}

RfnnBest RfnnAcrossNeurons(const DenseNet& net, const RfnnDecision& decision, float* workspace,
                           SimdLevel level) {
  return KernelsFor(level).across_neurons(net, decision, workspace);
}

RfnnBest RfnnArgmax(const DenseNet& net, const RfnnDecision& decision, float* workspace, SimdLevel level) {
  const DenseKernels& kernels = KernelsFor(level);
  return decision.n <= kRfnnFew ? kernels.across_neurons(net, decision, workspace)
                                : kernels.across_candidates(net, decision, workspace);
}

void RfnnValues(const DenseNet& net, const float* inputs, int n, float* values, float* workspace,
                SimdLevel level) {
  RfnnDecision decision;
  decision.actions = inputs;
  decision.n = n;
  decision.values = values;
  RfnnArgmax(net, decision, workspace, level);
}

}  // namespace ed3r::kernels
