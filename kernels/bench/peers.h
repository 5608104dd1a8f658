// Other people's libraries on the same work. Each computes the whole network on rows that it is handed
// ready-made, on one thread, with weights in the layout that it likes best.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kernels/dense_net.h"
#include "kernels/train.h"

namespace ed3r::bench {

class InferencePeer {
 public:
  virtual ~InferencePeer() = default;
  virtual void Values(const float* inputs, float* values) = 0;  // n rows of inputs, n values
};

// For n rows; flat as in dense_net.h.
using MakeInferencePeer = std::unique_ptr<InferencePeer>(const kernels::DenseShape& shape, const float* flat,
                                                         int n);

MakeInferencePeer MakeEigen;
MakeInferencePeer MakeOpenBlas;
MakeInferencePeer MakeOneDnn;
MakeInferencePeer MakeTorch;

struct NamedInferencePeer {
  std::string name;
  MakeInferencePeer* make;
};

// Those that this build has; the names of the others go to `missing`.
std::vector<NamedInferencePeer> InferencePeers(std::vector<std::string>* missing);

// One training step as in kernels/train.h: batch, dropout, Adam.
class TrainingPeer {
 public:
  virtual ~TrainingPeer() = default;
  // Returns the batch's mean squared error before the update.
  virtual double Step(const float* inputs, const float* targets, const std::uint32_t* rows, int n) = 0;
};

using MakeTrainingPeer = std::unique_ptr<TrainingPeer>(const kernels::DenseShape& shape, const float* flat,
                                                       const kernels::TrainOptions& options);

MakeTrainingPeer MakeEigenTraining;
MakeTrainingPeer MakeEigenTrainingWithOurDraws;  // dropout by the hash of kernels/train.h
MakeTrainingPeer MakeTorchTraining;

struct NamedTrainingPeer {
  std::string name;
  MakeTrainingPeer* make;
};
std::vector<NamedTrainingPeer> TrainingPeers(std::vector<std::string>* missing);

// Pointers to layer l of the flat form.
struct FlatLayer {
  const float* weights;  // out x in, row-major
  const float* biases;
  int in, out;
};
std::vector<FlatLayer> FlatLayers(const kernels::DenseShape& shape, const float* flat);

}  // namespace ed3r::bench
