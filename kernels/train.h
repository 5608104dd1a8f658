// Supervised training of a dense regression network: mean squared error, Adam, inverted dropout.
//
// One step on a batch of B rows (paper: batch 128, Adam with learning rate 5e-6, dropout 10 %):
//
//   forward    h_{l+1} = relu(W_l h_l + b_l) * keep / (1 - p) in every hidden layer, y linear
//   loss       L = 1/B sum (y - target)^2
//   backward   dL/dW, dL/db
//   Adam       m = beta1 m + (1 - beta1) g,  v = beta2 v + (1 - beta2) g^2,
//              w -= rate / (1 - beta1^t) * m / (sqrt(v / (1 - beta2^t)) + epsilon)
//
// Numbers. The result is a pure function of the parameters, the options and the rows given: the same bits at
// every SIMD level and for any number of threads. Each sum over inputs or outputs is fused and ascending. The
// gradient is summed over sub-blocks of kTrainRows rows: ascending inside a sub-block, then sub-block by
// sub-block in order, whatever thread computed them. 1 - beta and the bias corrections are computed in
// double.
//
// Dropout draws are counter-based: keep is a hash of (seed, step number, layer, row of the batch, neuron).
//
// Threads: one trainer must not be used by two threads at once; different trainers are independent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "kernels/dense_net.h"
#include "kernels/simd_level.h"

namespace ed3r::kernels {

// Rows of a sub-block: part of the definition of the result. With 32 a step takes 2 % longer; 128 gain 1 % more but leave
// nothing to a second thread.
inline constexpr int kTrainRows = 64;

struct TrainOptions {
  double learning_rate = 5e-6;
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-8;
  double dropout = 0.1;    // probability that a hidden neuron is zeroed, in [0, 1)
  std::uint64_t seed = 0;  // of the dropout draws
  int max_rows = 128;      // largest batch
  int threads = 1;         // OpenMP threads inside a step; useful up to max_rows / kTrainRows
  SimdLevel level = ActiveSimdLevel();
};

class DenseTrainer {
 public:
  // Starts from flat parameters (see dense_net.h), with m = v = 0. Throws std::invalid_argument on options
  // out of range.
  DenseTrainer(const DenseShape& shape, const float* flat_parameters, const TrainOptions& options);
  ~DenseTrainer();
  DenseTrainer(DenseTrainer&&) noexcept;
  DenseTrainer& operator=(DenseTrainer&&) noexcept;

  // One step on the rows `rows[0 .. n-1]` of the data set (inputs: row-major, shape.inputs() floats a row;
  // targets: one float a row). 1 <= n <= max_rows, else std::invalid_argument. Returns the batch's mean
  // squared error before the update, with dropout.
  double Step(const float* inputs, const float* targets, const std::uint32_t* rows, int n);

  // Mean squared error over n consecutive rows, without dropout; 0 for n = 0. Bitwise the values of
  // RfnnValues.
  double Evaluate(const float* inputs, const float* targets, std::size_t n) const;

  void Parameters(float* flat) const;  // ParameterCount(shape) floats
  void Gradient(float* flat) const;    // of the last Step, for tests
  DenseNet net() const;                // a view of the present parameters, valid until the next Step
  std::uint64_t steps() const;         // done so far

  // All that later steps depend on beside the options, to go on elsewhere with the same bits: parameters, m
  // and v, flat with ParameterCount(shape) floats each, and steps().
  void Save(float* parameters, float* m, float* v) const;
  void Restore(const float* parameters, const float* m, const float* v, std::uint64_t steps);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ed3r::kernels
