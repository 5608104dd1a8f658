// What the camera of a mission of the pixel tier saw, small enough for a page.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/mission/mission.h"

namespace ed3r::app {

// {number, width_px, height_px, jpeg: [one per timestep, base64]}: of each timestep's sensing period the frame in its
// middle, in the largest of some sizes in which all of them stay under kFramesBytes; fewer than timesteps where even the
// smallest is too large. Null for a mission that looked at no pixels.
nlohmann::ordered_json ViewerFrames(const mission::MissionTask& task, const mission::MissionRecord& flown);

inline constexpr std::size_t kFramesBytes = 700'000;  // base64; two missions on a page of 3 MB

}  // namespace ed3r::app
