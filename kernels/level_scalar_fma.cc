// Scalar level on a CPU with the scalar FMA instruction (compiled with -mfma, not vectorised): the same bits
// as level_scalar.cc, ten times as fast.
#include "kernels/level_scalar.h"
#include "kernels/rfnn_loops.h"
#include "kernels/train_loops.h"

namespace ed3r::kernels {

const DenseKernels& ScalarFmaKernels() {
  static constexpr DenseKernels kKernels{AcrossCandidates, AcrossNeurons, BlockGradient, AdamBlock};
  return kKernels;
}

}  // namespace ed3r::kernels
