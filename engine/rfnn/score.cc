#include "engine/rfnn/score.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/check.h"
#include "engine/rfnn/training_draws.h"

namespace ed3r::rfnn {
namespace {

// The inputs of the rows, one after the other.
std::vector<float> Gather(const DataSet& data, std::span<const std::uint32_t> rows) {
  std::vector<float> inputs;
  inputs.reserve(rows.size() * static_cast<std::size_t>(data.columns));
  for (const std::uint32_t r : rows) inputs.insert(inputs.end(), data.row(r).begin(), data.row(r).end());
  return inputs;
}

std::vector<double> Predictions(const Model& model, std::span<const float> inputs, std::size_t rows,
                                kernels::SimdLevel level) {
  Model::Workspace workspace(level);
  std::vector<double> predicted(rows);
  model.PredictRows(inputs, predicted, workspace);
  return predicted;
}

// Sums over the rows in order.
struct Errors {
  double squared = 0.0;
  double absolute = 0.0;
  double total = 0.0;  // squared distance to the mean target

  double R2() const { return total > 0.0 ? 1.0 - squared / total : std::numeric_limits<double>::quiet_NaN(); }
};

Errors ErrorsOf(const DataSet& data, std::span<const std::uint32_t> rows, std::span<const double> predicted) {
  double mean = 0.0;
  for (const std::uint32_t r : rows) mean += data.targets[r];
  mean /= static_cast<double>(rows.size());
  Errors errors;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double target = data.targets[rows[i]];
    const double error = predicted[i] - target;
    errors.squared += error * error;
    errors.absolute += std::abs(error);
    errors.total += (target - mean) * (target - mean);
  }
  return errors;
}

int CountMissions(const DataSet& data, std::span<const std::uint32_t> rows) {
  std::vector<std::int64_t> missions;
  for (const std::uint32_t r : rows) missions.push_back(data.missions[r]);
  std::sort(missions.begin(), missions.end());
  return static_cast<int>(std::unique(missions.begin(), missions.end()) - missions.begin());
}

}  // namespace

FitScore Score(const Model& model, const DataSet& data, std::span<const std::uint32_t> rows,
               kernels::SimdLevel level) {
  ED3R_CHECK(!rows.empty(), "no rows");
  const Errors errors = ErrorsOf(data, rows, Predictions(model, Gather(data, rows), rows.size(), level));
  const auto n = static_cast<double>(rows.size());
  const double mse = errors.squared / n;
  const double target_sd = model.data().scaling.target_sd;
  return {.rows = static_cast<int>(rows.size()),
          .missions = CountMissions(data, rows),
          .mse = mse / (target_sd * target_sd),
          .r2 = errors.R2(),
          .mae = errors.absolute / n,
          .rmse = std::sqrt(mse)};
}

std::vector<double> PermutationImportance(const Model& model, const DataSet& data,
                                          std::span<const std::uint32_t> rows, std::uint64_t seed,
                                          kernels::SimdLevel level) {
  ED3R_CHECK(!rows.empty(), "no rows");
  const std::vector<float> inputs = Gather(data, rows);
  const auto columns = static_cast<std::size_t>(data.columns);
  const double r2 = ErrorsOf(data, rows, Predictions(model, inputs, rows.size(), level)).R2();
  std::vector<double> importance;
  for (std::size_t c = 0; c < columns; ++c) {
    std::vector<float> values;
    for (std::size_t i = 0; i < rows.size(); ++i) values.push_back(inputs[i * columns + c]);
    Shuffle(values, TrainingStream(seed, TrainingDraw::kImportance, static_cast<int>(c)));
    std::vector<float> shuffled = inputs;
    for (std::size_t i = 0; i < rows.size(); ++i) shuffled[i * columns + c] = values[i];
    importance.push_back(r2 - ErrorsOf(data, rows, Predictions(model, shuffled, rows.size(), level)).R2());
  }
  return importance;
}

}  // namespace ed3r::rfnn
