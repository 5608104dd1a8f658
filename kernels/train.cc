#include "kernels/train.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/aligned_floats.h"
#include "kernels/dense_kernels.h"
#include "kernels/rfnn.h"

namespace ed3r::kernels {
namespace {

constexpr int kEvaluateRows = 1024;  // rows summed together by Evaluate: part of the definition of its result

void Require(bool condition, const std::string& what) {
  if (!condition) throw std::invalid_argument("training: " + what);
}

void CheckOptions(const TrainOptions& o) {
  Require(o.learning_rate > 0 && std::isfinite(o.learning_rate), "the learning rate must be positive");
  Require(o.beta1 >= 0 && o.beta1 < 1 && o.beta2 >= 0 && o.beta2 < 1, "beta1 and beta2 must be in [0, 1)");
  Require(o.epsilon > 0, "epsilon must be positive");
  Require(o.dropout >= 0 && o.dropout < 1, "dropout must be in [0, 1)");
  Require(o.max_rows >= 1, "max_rows must be at least 1");
  Require(o.threads >= 1, "threads must be at least 1");
}

std::uint64_t Mix(std::uint64_t z) {  // the finalizer of SplitMix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

// The keys of one step: two from each 64-bit draw.
void DrawKeys(std::uint64_t seed, std::uint64_t step, std::vector<std::uint32_t>* keys) {
  const std::uint64_t stream = Mix(Mix(seed + 0x9e3779b97f4a7c15u) + step);
  for (std::size_t k = 0; k < keys->size(); k += 2) {
    const std::uint64_t draw = Mix(stream + k * 0x9e3779b97f4a7c15u);
    (*keys)[k] = static_cast<std::uint32_t>(draw);
    (*keys)[k + 1] = static_cast<std::uint32_t>(draw >> 32);
  }
}

std::int32_t DropoutLimit(double p) {
  return static_cast<std::int32_t>(std::min(std::round((p - 0.5) * 4294967296.0), 2147483647.0));
}

}  // namespace

std::size_t TransposedLayerOffset(const DenseShape& shape, int layer) {
  std::size_t offset = 0;
  for (int l = 1; l < layer; ++l)
    offset += static_cast<std::size_t>(PadToBlock(shape.sizes[l])) * shape.sizes[l + 1];
  return offset;
}

std::size_t TransposedFloats(const DenseShape& shape) { return TransposedLayerOffset(shape, shape.layers); }

std::size_t TrainScratchFloats(const DenseShape& shape) {
  std::size_t row = 2 * static_cast<std::size_t>(WidestLayer(shape));
  for (int l = 0; l <= shape.layers; ++l) row += PadToBlock(shape.sizes[l]);
  return row * kTrainRows;
}

struct DenseTrainer::State {
  State(const DenseShape& shape, const TrainOptions& options);

  void FillTransposed();

  DenseShape shape;
  TrainOptions options;
  const DenseKernels* kernels;
  std::size_t size;  // of the packed form
  AlignedFloats packed, m, v, transposed;
  AlignedFloats gradients;  // one packed form per sub-block
  AlignedFloats scratch;    // one per thread
  std::vector<double> squares;
  std::size_t hidden = 0;                   // hidden neurons, layers padded to whole blocks
  std::vector<std::uint32_t> dropout_keys;  // of the hidden neurons, then of the rows
  int blocks = 0;                           // of the last step
  std::uint64_t steps = 0;
  double beta1_power = 1.0, beta2_power = 1.0;  // beta^steps, by multiplication: pow may differ between CPUs
};

DenseTrainer::State::State(const DenseShape& the_shape, const TrainOptions& the_options)
    : shape(the_shape),
      options(the_options),
      kernels(&KernelsFor(options.level)),
      size(PackedFloats(shape)),
      packed(size),
      m(size),
      v(size),
      transposed(TransposedFloats(shape)) {
  const int max_blocks = (options.max_rows + kTrainRows - 1) / kTrainRows;
  options.threads = std::min(options.threads, max_blocks);
  gradients = AlignedFloats(size * max_blocks);
  scratch = AlignedFloats(TrainScratchFloats(shape) * options.threads);
  squares.resize(max_blocks);
  for (int l = 1; l < shape.layers; ++l) hidden += PadToBlock(shape.sizes[l]);
  dropout_keys.resize(hidden + options.max_rows + options.max_rows % 2);
}

void DenseTrainer::State::FillTransposed() {
  for (int l = 1; l < shape.layers; ++l)
    for (int i = 0; i < shape.sizes[l]; ++i)
      for (int o = 0; o < shape.sizes[l + 1]; ++o) {
        const std::size_t from = PackedLayerOffset(shape, l) + o / kDenseBlock * PackedBlockStride(shape, l) +
                                 static_cast<std::size_t>(i + 1) * kDenseBlock + o % kDenseBlock;
        const std::size_t row = static_cast<std::size_t>(i / kDenseBlock) * shape.sizes[l + 1] + o;
        transposed.data()[TransposedLayerOffset(shape, l) + row * kDenseBlock + i % kDenseBlock] =
            packed.data()[from];
      }
}

DenseTrainer::DenseTrainer(const DenseShape& shape, const float* flat_parameters,
                           const TrainOptions& options) {
  CheckOptions(options);
  state_ = std::make_unique<State>(shape, options);
  PackParameters(shape, flat_parameters, state_->packed.data());
  state_->FillTransposed();
}

DenseTrainer::~DenseTrainer() = default;
DenseTrainer::DenseTrainer(DenseTrainer&&) noexcept = default;
DenseTrainer& DenseTrainer::operator=(DenseTrainer&&) noexcept = default;

double DenseTrainer::Step(const float* inputs, const float* targets, const std::uint32_t* rows, int n) {
  State& s = *state_;
  Require(n >= 1 && n <= s.options.max_rows, "a batch of " + std::to_string(n) + " rows, where 1 to " +
                                                 std::to_string(s.options.max_rows) + " are allowed");
  s.blocks = (n + kTrainRows - 1) / kTrainRows;
  ++s.steps;
  s.beta1_power *= s.options.beta1;
  s.beta2_power *= s.options.beta2;
  const TrainOptions& o = s.options;
  const AdamState adam{
      &s.shape,
      {static_cast<float>(o.beta1), static_cast<float>(1.0 - o.beta1), static_cast<float>(o.beta2),
       static_cast<float>(1.0 - o.beta2), static_cast<float>(o.learning_rate / (1.0 - s.beta1_power)),
       static_cast<float>(1.0 / std::sqrt(1.0 - s.beta2_power)), static_cast<float>(o.epsilon)},
      s.gradients.data(),
      s.blocks,
      s.packed.data(),
      s.m.data(),
      s.v.data(),
      s.transposed.data()};
  DrawKeys(o.seed, s.steps, &s.dropout_keys);
  const DropoutDraws draws{s.dropout_keys.data() + s.hidden, s.dropout_keys.data(), DropoutLimit(o.dropout),
                           static_cast<float>(1.0 / (1.0 - o.dropout))};
  const std::size_t scratch = TrainScratchFloats(s.shape);
#pragma omp parallel num_threads(o.threads) if (o.threads > 1)
  {
#pragma omp for schedule(static)
    for (int b = 0; b < s.blocks; ++b) {
      const int first = b * kTrainRows;
      s.squares[b] = s.kernels->gradient({&s.shape, s.packed.data(), s.transposed.data(), inputs, targets,
                                          rows + first, std::min(kTrainRows, n - first), first,
                                          static_cast<float>(2.0 / n), draws, s.gradients.data() + b * s.size,
                                          s.scratch.data() + omp_get_thread_num() * scratch});
    }
    for (int l = 0; l < s.shape.layers; ++l) {
      const int output_blocks = PadToBlock(s.shape.sizes[l + 1]) / kDenseBlock;
#pragma omp for schedule(static) nowait
      for (int b = 0; b < output_blocks; ++b) s.kernels->adam(adam, l, b);
    }
  }
  double squares = 0.0;
  for (int b = 0; b < s.blocks; ++b) squares += s.squares[b];
  return squares / n;
}

double DenseTrainer::Evaluate(const float* inputs, const float* targets, std::size_t n) const {
  const State& s = *state_;
  const long chunks = static_cast<long>((n + kEvaluateRows - 1) / kEvaluateRows);
  std::vector<double> squares(chunks);
#pragma omp parallel num_threads(s.options.threads) if (s.options.threads > 1)
  {
    AlignedFloats workspace(RfnnWorkspaceFloats(s.shape));
    std::vector<float> values(kEvaluateRows);
#pragma omp for schedule(static)
    for (long c = 0; c < chunks; ++c) {
      const std::size_t first = static_cast<std::size_t>(c) * kEvaluateRows;
      const int rows = static_cast<int>(std::min<std::size_t>(kEvaluateRows, n - first));
      RfnnValues(net(), inputs + first * s.shape.inputs(), rows, values.data(), workspace.data(),
                 s.options.level);
      for (int r = 0; r < rows; ++r) {
        const double error = static_cast<double>(values[r]) - targets[first + r];
        squares[c] += error * error;
      }
    }
  }
  double sum = 0.0;
  for (double part : squares) sum += part;
  return n > 0 ? sum / static_cast<double>(n) : 0.0;
}

void DenseTrainer::Parameters(float* flat) const {
  UnpackParameters(state_->shape, state_->packed.data(), flat);
}

void DenseTrainer::Gradient(float* flat) const {
  const State& s = *state_;
  std::vector<float> sum(s.gradients.data(), s.gradients.data() + s.size);
  for (int b = 1; b < s.blocks; ++b)
    for (std::size_t i = 0; i < s.size; ++i) sum[i] += s.gradients.data()[b * s.size + i];
  UnpackParameters(s.shape, sum.data(), flat);
}

DenseNet DenseTrainer::net() const { return {state_->shape, state_->packed.data()}; }

std::uint64_t DenseTrainer::steps() const { return state_->steps; }

void DenseTrainer::Save(float* parameters, float* m, float* v) const {
  const State& s = *state_;
  UnpackParameters(s.shape, s.packed.data(), parameters);
  UnpackParameters(s.shape, s.m.data(), m);
  UnpackParameters(s.shape, s.v.data(), v);
}

void DenseTrainer::Restore(const float* parameters, const float* m, const float* v, std::uint64_t steps) {
  State& s = *state_;
  PackParameters(s.shape, parameters, s.packed.data());
  PackParameters(s.shape, m, s.m.data());
  PackParameters(s.shape, v, s.v.data());
  s.FillTransposed();
  s.steps = steps;
  s.beta1_power = s.beta2_power = 1.0;
  for (std::uint64_t i = 0; i < steps; ++i) {  // the same products as step by step
    s.beta1_power *= s.options.beta1;
    s.beta2_power *= s.options.beta2;
  }
}

}  // namespace ed3r::kernels
