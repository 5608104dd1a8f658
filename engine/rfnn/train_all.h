// The networks of a study: many independent trainings on all cores, each trained once and kept.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/rfnn/trainer.h"

namespace ed3r::rfnn {

struct TrainAllOptions {
  std::string cache;  // folder of networks and checkpoints; made when missing; "" keeps nothing
  int threads = 1;    // trainings at a time, each on one thread
  const std::atomic<bool>* stop = nullptr;
  kernels::SimdLevel level = kernels::ActiveSimdLevel();
  // Called by one thread at a time; also for epochs of a job that stands in the list more than once.
  std::function<void(std::size_t job, int epoch, const EpochLoss& loss)> on_epoch;
  // Likewise, when a network is there, trained or read.
  std::function<void(std::size_t job)> on_done;
};

// networks[i] is the network of jobs[i]; null where `stop` came first: calling again continues there.
//
// A network is known by its content (TrainingKey): one that the cache holds is read instead of trained, and
// equal jobs share one network. Two sweeps with the same warm-up therefore train once, also when they run at
// the same time. The notes of a network that was read are those of the run that trained it. Which thread
// trains what has no influence on any bit.
//
// Errors of a training (see Train), and a damaged file in the cache, are thrown after the other trainings
// have ended; the first in the order of jobs wins.
std::vector<std::shared_ptr<const Model>> TrainAll(std::span<const TrainJob> jobs,
                                                   const TrainAllOptions& options);

// Where the cache keeps a network: "<cache>/<design>-<32 digits of the key>.rfnn".
std::string CachePath(const std::string& cache, const TrainJob& job);

}  // namespace ed3r::rfnn
