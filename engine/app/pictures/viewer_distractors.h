// The harmless things that misled the looks of a flown mission, for its viewer.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/mission/mission.h"

namespace ed3r::app {

// {"places": [[x_m, y_m, z_m, radius_m]...], "strongest": [of each timestep the index of the place in view that
// counted most, -1 for none: whether it changed the score tells fire_only_scs]}. Null in the pixel tier, where frames show what there was.
nlohmann::ordered_json ViewerDistractors(const mission::MissionTask& task,
                                         const mission::MissionRecord& record);

}  // namespace ed3r::app
