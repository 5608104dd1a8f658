// The random streams of a training. The numbers are part of every network: append, never renumber.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "engine/core/random.h"

namespace ed3r::rfnn {

enum class TrainingDraw : std::uint32_t {
  kSplit = 1,
  kWeights = 2,
  kShuffle = 3,
  kDropout = 4,
  kImportance = 5
};

inline Stream TrainingStream(std::uint64_t seed, TrainingDraw draw, int index = 0) {
  return Stream(seed, static_cast<std::uint32_t>(draw), Purpose::kTraining,
                static_cast<std::uint32_t>(index));
}

// Fisher-Yates. At most 2^32 - 1 values.
template <class T>
void Shuffle(std::vector<T>& values, Stream stream) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[stream.Below(static_cast<std::uint32_t>(i))]);
}

}  // namespace ed3r::rfnn
