// Scalar level for any CPU: the fused multiply-add comes from the C library.
#include "kernels/level_scalar.h"

#include "kernels/rfnn_loops.h"
#include "kernels/train_loops.h"

namespace ed3r::kernels {

const DenseKernels& ScalarKernels() {
  static constexpr DenseKernels kKernels{AcrossCandidates, AcrossNeurons, BlockGradient, AdamBlock};
  return kKernels;
}

}  // namespace ed3r::kernels
