// Internal: what each SIMD level provides, and the arguments it is called with. Plain data only: this header
// is compiled once per instruction set, and an inline function here could reach callers that lack it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/dense_net.h"
#include "kernels/rfnn.h"
#include "kernels/simd_level.h"

namespace ed3r::kernels {

// Candidates of the widest tile (AVX-512: 3 vectors of 16).
inline constexpr int kMaxTile = 48;

// Dropout of one step. Every row of the batch and every hidden neuron has a random key; neuron j of row r is
// dropped when int32(z) < limit for y = row_keys[r] ^ neuron_keys[j], z = (y ^ y >> 15) 0x846ca68b. Mixing
// the keys well once leaves five cheap instructions for a draw.
struct DropoutDraws {
  const std::uint32_t* row_keys;     // of the batch
  const std::uint32_t* neuron_keys;  // of the hidden layers one after the other, each padded to whole blocks
  std::int32_t limit;                // (p - 1/2) 2^32
  float scale;                       // 1 / (1 - p)
};

// One sub-block of a batch, n <= kTrainRows rows.
struct TrainBlock {
  const DenseShape* shape;
  const float* packed;
  const float* transposed;    // see TransposedFloats
  const float* inputs;        // the data set
  const float* targets;       //
  const std::uint32_t* rows;  // n rows of it
  int n;
  int first_row;       // of this sub-block in the batch
  float error_factor;  // 2 / rows of the batch
  DropoutDraws dropout;
  float* gradient;  // out, packed form
  float* scratch;   // TrainScratchFloats
};

// Adam's constants in one step; see train.h.
struct AdamStep {
  float beta1, one_minus_beta1;
  float beta2, one_minus_beta2;
  float rate;         // rate / (1 - beta1^t)
  float root_factor;  // 1 / sqrt(1 - beta2^t)
  float epsilon;
};

// What Adam updates: everything in packed form, gradients of `blocks` sub-blocks one after the other.
struct AdamState {
  const DenseShape* shape;
  AdamStep step;
  const float* gradients;
  int blocks;
  float* packed;
  float* m;
  float* v;
  float* transposed;
};

struct DenseKernels {
  RfnnBest (*across_candidates)(const DenseNet& net, const RfnnDecision& decision, float* workspace);
  RfnnBest (*across_neurons)(const DenseNet& net, const RfnnDecision& decision, float* workspace);
  // Fills the gradient of the batch's loss due to these rows; returns their sum of squared errors.
  double (*gradient)(const TrainBlock& block);
  // Updates one block of 16 outputs of a layer, and its part of the transposed weights.
  void (*adam)(const AdamState& state, int layer, int output_block);
};

// The backward pass reads the weights of layers 1 and up the other way round: layer by layer, per block of 16
// inputs one row of 16 weights per output.
std::size_t TransposedFloats(const DenseShape& shape);
std::size_t TransposedLayerOffset(const DenseShape& shape, int layer);
std::size_t TrainScratchFloats(const DenseShape& shape);

const DenseKernels& ScalarKernels();     // std::fma by the C library: any CPU
const DenseKernels& ScalarFmaKernels();  // the same code where the CPU has the scalar instruction
const DenseKernels& Avx2Kernels();
const DenseKernels& Avx512Kernels();

// The kernels of a level. Throws SimdLevelError where this CPU lacks it.
const DenseKernels& KernelsFor(SimdLevel level);

}  // namespace ed3r::kernels
