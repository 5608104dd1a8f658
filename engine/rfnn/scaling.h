// Standardisation of inputs and target: zero mean and unit standard deviation over the training rows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/rfnn/data_set.h"

namespace ed3r::rfnn {

struct Scaling {
  std::vector<double> input_mean;
  std::vector<double> input_sd;  // 0 for an input that is constant in the training rows: it becomes 0
  double target_mean = 0.0;
  double target_sd = 1.0;  // > 0
};

// Of the given rows only: held-out rows must not leak into the scale. At least one row.
Scaling FitScaling(const DataSet& data, std::span<const std::uint32_t> rows);

// The one definition of a standardised input, for training and for inference: raw values are rounded to float
// first, so that a recorded row gives the same bits in both.
class InputScaler {
 public:
  explicit InputScaler(const Scaling& scaling);

  // to[i] = (from[i] - mean) / sd for the columns first, first + 1, ...; `to` has the size of `from`.
  void Standardize(std::span<const float> from, int first, float* to) const;

 private:
  std::vector<double> mean_;
  std::vector<double> inverse_;  // 1 / sd, or 0
};

inline float StandardizeTarget(const Scaling& scaling, float target) {
  return static_cast<float>((static_cast<double>(target) - scaling.target_mean) / scaling.target_sd);
}
inline double RawTarget(const Scaling& scaling, float standardised) {
  return scaling.target_mean + scaling.target_sd * static_cast<double>(standardised);
}

}  // namespace ed3r::rfnn
