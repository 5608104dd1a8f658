// The fast tier ("profile"): confidences of one sensing period from what the camera could see (engine/config/perception.h
// holds the formula and its parameters).
#pragma once

#include <cstdint>

#include "engine/config/perception.h"
#include "engine/perception/score.h"
#include "engine/perception/sensor.h"
#include "engine/perception/view.h"

namespace ed3r {

// Keyed draws: both models meet the same fluctuation at a timestep, so that arms differ by the model alone.
Score DetectFromProfile(const View& view, const PerceptionConfig& perception, DetectionModel model,
                        int frames, std::uint64_t seed, std::uint32_t scenario, std::uint32_t timestep);

}  // namespace ed3r
