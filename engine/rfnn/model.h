// A trained regression feedforward neural network (RFNN): what an agent asks for the reward that an action
// would bring.
//
// Inputs and rewards are raw, in the units of the design's features; standardising happens inside.
// Standardised inputs are not folded into the weights of layer 1: that would save 1 % of a decision among
// 1000 candidates and cost digits where a feature's mean is large against its spread (the bandwidth).
//
// Numbers: the same bits at every SIMD level and for any number of candidates (kernels/rfnn.h).
// Threads: a Model is immutable; any number of threads may ask it, each with a Workspace of its own.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/rfnn/features.h"
#include "engine/rfnn/scaling.h"
#include "engine/rfnn/training_report.h"
#include "kernels/aligned_floats.h"
#include "kernels/dense_net.h"
#include "kernels/simd_level.h"

namespace ed3r::rfnn {

// Where a network comes from: data hash, seed, every training parameter, code version, and what the caller
// adds. One-line texts.
using Provenance = std::vector<std::pair<std::string, std::string>>;

// All that a model file holds beyond the design.
struct ModelData {
  std::vector<float> weights;  // flat (kernels/dense_net.h), on standardised inputs and target
  Scaling scaling;
  TrainingReport report;
  Provenance provenance;
  std::string key = {};  // TrainingKey of the job that made it; "" for one that no job made
};

struct BestAction {
  int index = -1;
  double reward = 0.0;
};

// The kernel's shape of a design: inputs, hidden layers, one output.
kernels::DenseShape ShapeOf(const NetworkDesign& design);

class Model {
 public:
  // Scratch memory of one thread, for any number of models. Grows to what the largest question needs.
  class Workspace {
   public:
    explicit Workspace(kernels::SimdLevel level = kernels::ActiveSimdLevel()) : level_(level) {}

   private:
    friend class Model;
    kernels::SimdLevel level_;
    kernels::AlignedFloats kernel_;
    std::vector<float> state_, actions_, values_;
  };

  // Sizes that do not fit the design are an InternalError; files are checked where they are read.
  Model(const NetworkDesign& design, ModelData data);

  // The action with the largest predicted reward; the lowest index among equals.
  //   state: design().states values.   actions: n x design().actions(), row-major, n >= 1.
  // Other sizes, and a prediction that is not finite, are an InternalError.
  BestAction Best(std::span<const double> state, std::span<const float> actions, Workspace& workspace) const;

  // The same with every candidate's predicted reward; `rewards` has n values.
  BestAction Best(std::span<const double> state, std::span<const float> actions, std::span<double> rewards,
                  Workspace& workspace) const;

  double Predict(std::span<const double> state, std::span<const float> action, Workspace& workspace) const;

  // rewards[r] for row r of `rows` (whole rows of inputs, row-major). Bitwise what Best would say.
  void PredictRows(std::span<const float> rows, std::span<double> rewards, Workspace& workspace) const;

  const NetworkDesign& design() const { return design_; }
  const ModelData& data() const { return data_; }

 private:
  kernels::DenseNet net() const { return {shape_, packed_.data()}; }
  BestAction Ask(std::span<const double> state, std::span<const float> actions, float* values,
                 Workspace& workspace) const;

  NetworkDesign design_;
  ModelData data_;
  kernels::DenseShape shape_;
  InputScaler scaler_;
  kernels::AlignedFloats packed_;
};

}  // namespace ed3r::rfnn
