#include "engine/rfnn/direct_network.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "engine/core/check.h"

namespace ed3r::rfnn {

DirectNetwork::DirectNetwork(std::vector<Model> values) : values_(std::move(values)) {
  ED3R_CHECK(!values_.empty(), "a network without values");
  for (const Model& value : values_)
    ED3R_CHECK(value.design().inputs() == values_.front().design().inputs(), "networks of different inputs");
}

void DirectNetwork::Decide(std::span<const double> state, std::span<double> decision,
                           Model::Workspace& workspace) const {
  ED3R_CHECK(decision.size() == values_.size(), fmt::format("{} values of a decision", decision.size()));
  const std::vector<float> row(state.begin(), state.end());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i].PredictRows(row, decision.subspan(i, 1), workspace);
    ED3R_CHECK(std::isfinite(decision[i]), fmt::format("network '{}' gives {} as value {} of its decision",
                                                       values_[i].design().name, decision[i], i + 1));
  }
}

}  // namespace ed3r::rfnn
