// From what a sweep file says to the stages and arms that are flown.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/sweep/plan.h"
#include "engine/sweep/sweep_source.h"

namespace ed3r::sweep {

// Missions per arm as --missions says them, by stage; "" is for the flying stages that are not named.
using MissionCounts = std::map<std::string, WrittenCount>;

// Expands every stage. `overrides` are the settings of --set. Throws UserError: missions of a stage that is not
// there or does not fly, an override or a setting of a key that an axis varies, two arms of one name, no
// arm left, rules between parameters (CheckParameters), too many arms or missions. Sizes are checked before
// anything of that size is built.
std::vector<Stage> ExpandStages(const SweepSource& source, const std::vector<Setting>& overrides,
                                const MissionCounts& missions);

}  // namespace ed3r::sweep
