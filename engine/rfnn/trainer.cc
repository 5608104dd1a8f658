#include "engine/rfnn/trainer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "engine/core/check.h"
#include "engine/core/sha256.h"
#include "engine/rfnn/checkpoint.h"
#include "engine/rfnn/score.h"
#include "engine/rfnn/training_draws.h"
#include "kernels/train.h"

namespace ed3r::rfnn {
namespace {

// The parameters that shape one network, as provenance; neither the number of networks is among
// them nor which missions they learn from, whose rows have a fingerprint of their own.
struct ConfigTexts {
  Provenance texts;
  template <class T>
  void operator()(std::string_view name, const T& field, const FieldInfo& /*info*/) {
    if (name != "seeds" && name != "seed" && name != "own_warmups")
      texts.emplace_back(fmt::format("training.{}", name), fmt::format("{}", field));
  }
};

Provenance ProvenanceOf(const TrainJob& job) {
  ConfigTexts config;
  TrainingConfig::Describe(job.config, config);
  Provenance all = {{"design", std::string(job.design.name)},
                    {"data_sha256", Fingerprint(*job.data)},
                    {"seed", fmt::format("{}", job.seed)},
                    {"code", job.code_version}};
  all.insert(all.end(), config.texts.begin(), config.texts.end());
  return all;
}

// He et al. 2015 for layers of ReLU: uniform in +- sqrt(6 / inputs), biases zero.
std::vector<float> InitialWeights(const kernels::DenseShape& shape, std::uint64_t seed) {
  Stream stream = TrainingStream(seed, TrainingDraw::kWeights);
  std::vector<float> weights;
  weights.reserve(kernels::ParameterCount(shape));
  for (int l = 0; l < shape.layers; ++l) {
    const double limit = std::sqrt(6.0 / shape.sizes[l]);
    for (int i = 0; i < shape.sizes[l] * shape.sizes[l + 1]; ++i)
      weights.push_back(static_cast<float>(stream.Uniform(-limit, limit)));
    weights.insert(weights.end(), static_cast<std::size_t>(shape.sizes[l + 1]), 0.0f);
  }
  return weights;
}

kernels::TrainOptions OptionsOf(const TrainJob& job, const TrainControl& control, std::size_t rows) {
  Stream stream = TrainingStream(job.seed, TrainingDraw::kDropout);
  const std::uint64_t high = stream.Bits();
  return {.learning_rate = job.config.learning_rate,
          .dropout = job.config.dropout,
          .seed = high << 32 | stream.Bits(),
          .max_rows = static_cast<int>(std::min(static_cast<std::size_t>(job.config.batch), rows)),
          .threads = control.threads,
          .level = control.level};
}

// One part of the split, standardised.
struct Part {
  std::vector<float> inputs, targets;
  std::size_t rows() const { return targets.size(); }
};

Part Standardized(const DataSet& data, std::span<const std::uint32_t> rows, const Scaling& scaling) {
  const InputScaler scaler(scaling);
  const auto columns = static_cast<std::size_t>(data.columns);
  Part part;
  part.inputs.resize(rows.size() * columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    scaler.Standardize(data.row(rows[i]), 0, part.inputs.data() + i * columns);
    part.targets.push_back(StandardizeTarget(scaling, data.targets[rows[i]]));
  }
  return part;
}

// A training from its first epoch, or from a checkpoint, to its last.
class Training {
 public:
  Training(const TrainJob& job, const TrainControl& control)
      : job_(job),
        control_(control),
        shape_(ShapeOf(job.design)),
        split_(MakeSplit(job.data->missions, static_cast<std::uint64_t>(job.config.split_seed))),
        scaling_(FitScaling(*job.data, split_.train)),
        train_(Standardized(*job.data, split_.train, scaling_)),
        validation_(Standardized(*job.data, split_.validation, scaling_)),
        best_weights_(InitialWeights(shape_, job.seed)),
        trainer_(shape_, best_weights_.data(), OptionsOf(job, control, train_.rows())) {}

  int epochs() const { return static_cast<int>(curve_.size()); }
  const EpochLoss& last_loss() const { return curve_.back(); }
  bool OutOfPatience() const { return epochs() - best_epoch_ >= job_.config.patience; }
  bool Finished() const { return epochs() >= job_.config.epochs || OutOfPatience(); }

  void RunEpoch();
  void Save(const std::string& key) const;
  void Continue(const std::string& key);
  Model Finish();

 private:
  const TrainJob& job_;
  const TrainControl& control_;
  kernels::DenseShape shape_;
  Split split_;
  Scaling scaling_;
  Part train_, validation_;
  std::vector<float> best_weights_;
  kernels::DenseTrainer trainer_;
  std::vector<EpochLoss> curve_;
  double best_validation_ = std::numeric_limits<double>::infinity();
  int best_epoch_ = 0;
};

void Training::RunEpoch() {
  std::vector<std::uint32_t> order(train_.rows());
  std::iota(order.begin(), order.end(), 0u);
  Shuffle(order, TrainingStream(job_.seed, TrainingDraw::kShuffle, epochs() + 1));
  const auto batch = static_cast<std::size_t>(job_.config.batch);
  double squares = 0.0;
  for (std::size_t at = 0; at < order.size(); at += batch) {
    const int n = static_cast<int>(std::min(batch, order.size() - at));
    squares += n * trainer_.Step(train_.inputs.data(), train_.targets.data(), order.data() + at, n);
  }
  const double validation =
      trainer_.Evaluate(validation_.inputs.data(), validation_.targets.data(), validation_.rows());
  curve_.push_back({squares / static_cast<double>(order.size()), validation});
  // A NaN is never better: a training that diverges runs out of patience.
  if (validation < best_validation_ - job_.config.min_delta) {
    best_validation_ = validation;
    best_epoch_ = epochs();
    trainer_.Parameters(best_weights_.data());
  }
}

void Training::Save(const std::string& key) const {
  Checkpoint checkpoint;
  checkpoint.key = key;
  checkpoint.best_weights = best_weights_;
  checkpoint.best_validation = best_validation_;
  checkpoint.best_epoch = best_epoch_;
  checkpoint.curve = curve_;
  TrainerState& state = checkpoint.trainer;
  state.steps = trainer_.steps();
  for (auto* floats : {&state.parameters, &state.first_moments, &state.second_moments})
    floats->resize(kernels::ParameterCount(shape_));
  trainer_.Save(state.parameters.data(), state.first_moments.data(), state.second_moments.data());
  WriteCheckpoint(control_.checkpoint, checkpoint);
}

void Training::Continue(const std::string& key) {
  Checkpoint checkpoint = ReadCheckpoint(control_.checkpoint, key, kernels::ParameterCount(shape_));
  const TrainerState& state = checkpoint.trainer;
  trainer_.Restore(state.parameters.data(), state.first_moments.data(), state.second_moments.data(),
                   state.steps);
  best_weights_ = std::move(checkpoint.best_weights);
  best_validation_ = checkpoint.best_validation;
  best_epoch_ = checkpoint.best_epoch;
  curve_ = std::move(checkpoint.curve);
}

Model Training::Finish() {
  if (best_epoch_ == 0)
    throw UserError(fmt::format(
        "training.learning_rate: '{}' makes the {} network diverge: no finite validation error in {} epochs",
        job_.config.learning_rate, job_.design.name, epochs()));
  ModelData data;
  data.weights = best_weights_;
  data.scaling = scaling_;
  data.key = TrainingKey(job_);
  data.provenance = ProvenanceOf(job_);
  data.provenance.insert(data.provenance.end(), job_.notes.begin(), job_.notes.end());
  TrainingReport& report = data.report;
  report.curve = curve_;
  report.best_epoch = best_epoch_;
  report.stopped_early = OutOfPatience();
  const Model model(job_.design, data);
  report.train = Score(model, *job_.data, split_.train, control_.level);
  report.validation = Score(model, *job_.data, split_.validation, control_.level);
  report.test = Score(model, *job_.data, split_.test, control_.level);
  return Model(job_.design, std::move(data));
}

}  // namespace

std::string TrainingKey(const TrainJob& job) {
  Sha256 hash;
  hash.Update(fmt::format("{} | {} | {}\n", fmt::join(job.design.features, " "), job.design.states,
                          fmt::join(job.design.hidden, " ")));
  for (const auto& [key, value] : ProvenanceOf(job)) hash.Update(fmt::format("{}={}\n", key, value));
  return hash.Hex();
}

std::optional<Model> Train(const TrainJob& job, const TrainControl& control) {
  ED3R_CHECK(job.data && job.data->columns == job.design.inputs(), std::string(job.design.name));
  const bool resumable = !control.checkpoint.empty();
  const std::string key = resumable ? TrainingKey(job) : "";
  Training training(job, control);
  if (resumable && std::filesystem::exists(control.checkpoint)) training.Continue(key);
  while (!training.Finished()) {
    const bool stopped = control.stop && control.stop->load(std::memory_order_relaxed);
    const bool due = training.epochs() > 0 && training.epochs() % control.checkpoint_epochs == 0;
    if (resumable && (due || (stopped && training.epochs() > 0))) training.Save(key);
    if (stopped) return std::nullopt;
    training.RunEpoch();
    if (control.on_epoch) control.on_epoch(training.epochs(), training.last_loss());
  }
  return training.Finish();
}

}  // namespace ed3r::rfnn
