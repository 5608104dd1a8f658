#include "engine/rfnn/model.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/core/check.h"
#include "kernels/rfnn.h"

namespace ed3r::rfnn {
namespace {

template <class Floats>
float* Reserve(Floats& floats, std::size_t size) {
  if (floats.size() < size) floats = Floats(size);
  return floats.data();
}

}  // namespace

kernels::DenseShape ShapeOf(const NetworkDesign& design) {
  std::vector<int> sizes = {design.inputs()};
  sizes.insert(sizes.end(), design.hidden.begin(), design.hidden.end());
  sizes.push_back(1);
  return kernels::MakeDenseShape(sizes.data(), static_cast<int>(sizes.size()));
}

Model::Model(const NetworkDesign& design, ModelData data)
    : design_(design),
      data_(std::move(data)),
      shape_(ShapeOf(design)),
      scaler_(data_.scaling),
      packed_(kernels::PackedFloats(shape_)) {
  const auto inputs = static_cast<std::size_t>(design.inputs());
  ED3R_CHECK(data_.weights.size() == kernels::ParameterCount(shape_),
             fmt::format("{} weights", data_.weights.size()));
  ED3R_CHECK(data_.scaling.input_mean.size() == inputs && data_.scaling.input_sd.size() == inputs, "scaling");
  ED3R_CHECK(data_.scaling.target_sd > 0.0, "scaling of the target");
  kernels::PackParameters(shape_, data_.weights.data(), packed_.data());
}

BestAction Model::Ask(std::span<const double> state, std::span<const float> actions, float* values,
                      Workspace& workspace) const {
  const auto n_state = static_cast<std::size_t>(design_.states);
  const auto n_action = static_cast<std::size_t>(design_.actions());
  ED3R_CHECK(state.size() == n_state, fmt::format("{} state values", state.size()));
  ED3R_CHECK(!actions.empty() && actions.size() % n_action == 0,
             fmt::format("{} action values", actions.size()));
  float* x = Reserve(workspace.state_, n_state);
  for (std::size_t i = 0; i < n_state; ++i) x[i] = static_cast<float>(state[i]);
  scaler_.Standardize({x, n_state}, 0, x);
  float* a = Reserve(workspace.actions_, actions.size());
  for (std::size_t at = 0; at < actions.size(); at += n_action)
    scaler_.Standardize(actions.subspan(at, n_action), design_.states, a + at);
  const kernels::RfnnDecision decision{.state = x,
                                       .n_state = design_.states,
                                       .actions = a,
                                       .n = static_cast<int>(actions.size() / n_action),
                                       .values = values};
  const kernels::RfnnBest best = kernels::RfnnArgmax(
      net(), decision, Reserve(workspace.kernel_, kernels::RfnnWorkspaceFloats(shape_)), workspace.level_);
  ED3R_CHECK(std::isfinite(best.value),
             fmt::format("network '{}' predicts {} for its best action", design_.name, best.value));
  return {best.index, RawTarget(data_.scaling, best.value)};
}

BestAction Model::Best(std::span<const double> state, std::span<const float> actions,
                       Workspace& workspace) const {
  return Ask(state, actions, nullptr, workspace);
}

BestAction Model::Best(std::span<const double> state, std::span<const float> actions,
                       std::span<double> rewards, Workspace& workspace) const {
  ED3R_CHECK(rewards.size() * static_cast<std::size_t>(design_.actions()) == actions.size(),
             fmt::format("{} rewards", rewards.size()));
  float* values = Reserve(workspace.values_, rewards.size());
  const BestAction best = Ask(state, actions, values, workspace);
  for (std::size_t i = 0; i < rewards.size(); ++i) rewards[i] = RawTarget(data_.scaling, values[i]);
  return best;
}

double Model::Predict(std::span<const double> state, std::span<const float> action,
                      Workspace& workspace) const {
  ED3R_CHECK(action.size() == static_cast<std::size_t>(design_.actions()), "one action");
  return Ask(state, action, nullptr, workspace).reward;
}

void Model::PredictRows(std::span<const float> rows, std::span<double> rewards, Workspace& workspace) const {
  const auto inputs = static_cast<std::size_t>(design_.inputs());
  ED3R_CHECK(rewards.size() * inputs == rows.size(), fmt::format("{} rewards", rewards.size()));
  float* x = Reserve(workspace.actions_, rows.size());
  for (std::size_t at = 0; at < rows.size(); at += inputs)
    scaler_.Standardize(rows.subspan(at, inputs), 0, x + at);
  float* values = Reserve(workspace.values_, rewards.size());
  kernels::RfnnValues(net(), x, static_cast<int>(rewards.size()), values,
                      Reserve(workspace.kernel_, kernels::RfnnWorkspaceFloats(shape_)), workspace.level_);
  for (std::size_t r = 0; r < rewards.size(); ++r) rewards[r] = RawTarget(data_.scaling, values[r]);
}

}  // namespace ed3r::rfnn
