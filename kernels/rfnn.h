// Inference of a regression feedforward neural network (RFNN) on the candidate actions of one decision.
//
// Candidate c has the inputs (state, actions[c]): the state comes first, and its part of layer 1 is computed
// once per decision. The result is the candidate with the largest predicted value.
//
// Numbers. Every sum starts at its bias and runs over the inputs in ascending order with fused multiply-add.
// Values therefore do not depend on the SIMD level, on the number of candidates, on which of the functions
// below computed them, on where the state ends and the action begins, or on alignment: they agree bit for
// bit, for infinities and denormals too (flush-to-zero is never set here). A NaN is always the positive quiet
// NaN.
//
// Choice. Ties go to the lowest index; +0 and -0 tie. A NaN never wins against a number; when all values are
// NaN the result is index 0 with a NaN value, which a caller should treat as a fault. n = 0 gives index -1,
// NaN.
//
// Threads: all functions are pure; concurrent calls need a workspace each.
#pragma once

#include <cstddef>

#include "kernels/dense_net.h"
#include "kernels/simd_level.h"

namespace ed3r::kernels {

struct RfnnBest {
  int index = -1;
  float value = 0.0f;
};

// Arguments of one decision. Unaligned pointers are fine; nothing may overlap.
//   state     n_state floats, 0 <= n_state <= inputs
//   actions   n rows of inputs - n_state floats
//   values    receives n predicted values; null where they are not wanted
struct RfnnDecision {
  const float* state = nullptr;
  int n_state = 0;
  const float* actions = nullptr;
  int n = 0;
  float* values = nullptr;
};

// Floats of scratch memory that any call with this shape needs, at any level and number of candidates.
std::size_t RfnnWorkspaceFloats(const DenseShape& shape);

// Largest n for which RfnnArgmax and RfnnValues work across neurons.
inline constexpr int kRfnnFew = 8;

// The best candidate. Works across neurons for up to kRfnnFew candidates, across candidates above.
RfnnBest RfnnArgmax(const DenseNet& net, const RfnnDecision& decision, float* workspace,
                    SimdLevel level = ActiveSimdLevel());

// The two ways of working, for tests and measurements. Each accepts any n.
RfnnBest RfnnAcrossCandidates(const DenseNet& net, const RfnnDecision& decision, float* workspace,
                              SimdLevel level = ActiveSimdLevel());
RfnnBest RfnnAcrossNeurons(const DenseNet& net, const RfnnDecision& decision, float* workspace,
                           SimdLevel level = ActiveSimdLevel());

// values[r] = the network on row r of inputs (n x inputs, row-major).
void RfnnValues(const DenseNet& net, const float* inputs, int n, float* values, float* workspace,
                SimdLevel level = ActiveSimdLevel());

}  // namespace ed3r::kernels
