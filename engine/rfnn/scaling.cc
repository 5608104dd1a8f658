#include "engine/rfnn/scaling.h"

#include <cmath>

#include "engine/core/check.h"

namespace ed3r::rfnn {
namespace {

struct Moments {
  double mean = 0.0;
  double sd = 0.0;
};

// Two passes, ascending. `value(r)` for each of the rows.
template <class Value>
Moments MomentsOf(std::span<const std::uint32_t> rows, Value value) {
  const auto n = static_cast<double>(rows.size());
  Moments m;
  bool constant = true;
  for (const std::uint32_t r : rows) {
    m.mean += value(r);
    constant = constant && value(r) == value(rows[0]);
  }
  m.mean /= n;
  if (constant) return {value(rows[0]), 0.0};  // rounding of the mean must not pass for a spread
  double squares = 0.0;
  for (const std::uint32_t r : rows) squares += (value(r) - m.mean) * (value(r) - m.mean);
  m.sd = std::sqrt(squares / n);
  return m;
}

}  // namespace

Scaling FitScaling(const DataSet& data, std::span<const std::uint32_t> rows) {
  ED3R_CHECK(!rows.empty(), "no rows");
  Scaling scaling;
  const auto columns = static_cast<std::size_t>(data.columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const Moments m =
        MomentsOf(rows, [&](std::uint32_t r) -> double { return data.inputs[r * columns + c]; });
    scaling.input_mean.push_back(m.mean);
    scaling.input_sd.push_back(m.sd);
  }
  const Moments m = MomentsOf(rows, [&](std::uint32_t r) -> double { return data.targets[r]; });
  scaling.target_mean = m.mean;
  scaling.target_sd = m.sd > 0.0 ? m.sd : 1.0;
  return scaling;
}

InputScaler::InputScaler(const Scaling& scaling) : mean_(scaling.input_mean) {
  for (const double sd : scaling.input_sd) inverse_.push_back(sd > 0.0 ? 1.0 / sd : 0.0);
}

void InputScaler::Standardize(std::span<const float> from, int first, float* to) const {
  const double* mean = mean_.data() + first;
  const double* inverse = inverse_.data() + first;
  for (std::size_t i = 0; i < from.size(); ++i)
    to[i] = static_cast<float>((static_cast<double>(from[i]) - mean[i]) * inverse[i]);
}

}  // namespace ed3r::rfnn
