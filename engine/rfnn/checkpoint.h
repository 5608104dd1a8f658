// A training in the middle: everything that the next epoch depends on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/rfnn/training_report.h"

namespace ed3r::rfnn {

// Of kernels' DenseTrainer; flat (kernels/dense_net.h).
struct TrainerState {
  std::uint64_t steps = 0;
  std::vector<float> parameters, first_moments, second_moments;
};

struct Checkpoint {
  std::string key;  // TrainingKey of the job: nothing else may continue it
  TrainerState trainer;
  std::vector<float> best_weights;  // flat
  double best_validation = 0.0;
  int best_epoch = 0;
  std::vector<EpochLoss> curve;  // one entry per epoch done
};

// Atomic: see sealed_file.h. Throws UserError where the disk refuses.
void WriteCheckpoint(const std::string& path, const Checkpoint& checkpoint);

// Throws UserError, one line that starts with the path, for a file that is missing, damaged, of another
// version, or of another training than `key` with `parameters` weights. Deleting the file starts that
// training anew, with the same result.
Checkpoint ReadCheckpoint(const std::string& path, const std::string& key, std::size_t parameters);

}  // namespace ed3r::rfnn
