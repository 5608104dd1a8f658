// Supervised regression of the reward on the warm-up log (paper: Offline Training, ED3R Configuration Setup;
// R18): mean squared error, Adam, dropout, early stopping on held-out missions.
//
// One network is a pure function of (design, data, training parameters, seed, code): the same bits for any
// number of threads, at every SIMD level, with any interruption and continuation.
//
// Where the paper is silent (A49): weights start He-uniform and biases at zero; inputs and target are
// standardised over the training rows; rows are shuffled anew every epoch; dropout follows every hidden
// layer; the weights of the epoch with the smallest validation error are kept.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "engine/config/training.h"
#include "engine/rfnn/data_set.h"
#include "engine/rfnn/model.h"
#include "kernels/simd_level.h"

namespace ed3r::rfnn {

// What to train. `data` must outlive the training.
struct TrainJob {
  NetworkDesign design;
  const DataSet* data = nullptr;
  TrainingConfig config;     // its seeds and seed do not matter here
  std::uint64_t seed = 0;    // initial weights, shuffles, dropout
  std::string code_version;  // of the program; part of the key
  Provenance notes;          // kept with the network, not part of the key: which warm-up, which eta_min
};

// How to train it: no influence on the result.
struct TrainControl {
  const std::atomic<bool>* stop = nullptr;  // looked at after every epoch
  std::string checkpoint;                   // file to continue from and to leave when stopped; "" for none
  int checkpoint_epochs = 100;              // also written every so many epochs, for power cuts and kills
  int threads = 1;
  kernels::SimdLevel level = kernels::ActiveSimdLevel();
  std::function<void(int epoch, const EpochLoss& loss)> on_epoch;
};

// SHA-256 over all that the network depends on: the name of its place in a cache, equal for equal networks.
std::string TrainingKey(const TrainJob& job);

// The network, or nothing when stopped. A stopped training leaves its checkpoint; calling again continues and
// ends in the same bits. A finished one leaves the last checkpoint to be removed by the caller once the
// network is safe. Throws UserError for fewer than 3 missions, for a training that diverges, and for a
// checkpoint that is damaged or not of this job.
std::optional<Model> Train(const TrainJob& job, const TrainControl& control = {});

}  // namespace ed3r::rfnn
