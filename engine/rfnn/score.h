// How good a network is, and what it looks at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/rfnn/model.h"

namespace ed3r::rfnn {

// The fit of a network on some rows of a data set; at least one row.
FitScore Score(const Model& model, const DataSet& data, std::span<const std::uint32_t> rows,
               kernels::SimdLevel level = kernels::ActiveSimdLevel());

// Permutation importance: for each input, how much R2 falls when that input's values are shuffled among the
// rows. About 0 for an input that the network does not use; inputs that carry the same information share
// their importance. NaN where R2 is.
std::vector<double> PermutationImportance(const Model& model, const DataSet& data,
                                          std::span<const std::uint32_t> rows, std::uint64_t seed,
                                          kernels::SimdLevel level = kernels::ActiveSimdLevel());

}  // namespace ed3r::rfnn
