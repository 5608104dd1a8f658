// A warm-up log without an engine: random walks past fires, for measuring trainings at their real size and
// signal-to-noise ratio before any mission has been flown. Not used by any result.
#pragma once

#include <cstdint>

#include "engine/rfnn/data_set.h"

namespace ed3r::rfnn {

// The same timesteps as rows of each network.
struct SyntheticWarmUp {
  DataSet rc;
  DataSet robot;
};

// `missions` walks of `timesteps` each past one of six fires; which one, no input tells.
SyntheticWarmUp MakeSyntheticWarmUp(int missions, int timesteps, std::uint64_t seed);

}  // namespace ed3r::rfnn
