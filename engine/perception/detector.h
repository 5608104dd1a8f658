// The fast tier ("profile"): confidences of one sensing period from what the camera could see (engine/config/perception.h
// holds the formula and its parameters).
#pragma once

#include <cstdint>

#include "engine/config/perception.h"
#include "engine/perception/score.h"
#include "engine/perception/sensor.h"
#include "engine/perception/view.h"

namespace ed3r::perception {

// Keys of a look's draws: both models meet the same fluctuation, so that arms differ by the model alone.
struct LookDraws {
  std::uint64_t seed = 0;
  std::uint32_t scenario = 0;
  std::uint32_t timestep = 1;  // of the frames
  std::uint32_t view = 1;      // the timestep whose fluctuation the view has
};

Score DetectFromProfile(const View& view, const PerceptionConfig& perception, DetectionModel model,
                        int frames, const LookDraws& draws);

}  // namespace ed3r::perception
