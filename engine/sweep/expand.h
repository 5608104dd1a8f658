// From what a sweep file says to the stages and arms that are flown.
#pragma once

#include <optional>
#include <vector>

#include "engine/sweep/plan.h"
#include "engine/sweep/sweep_source.h"

namespace ed3r {

// Expands every stage. `overrides` are the settings of --set; `missions` that of --missions, for the stages
// that fly. Throws UserError: an override or a setting of a key that an axis varies, two arms of one name, no
// arm left, rules between parameters (CheckParameters), too many arms or missions. Sizes are checked before
// anything of that size is built.
std::vector<Stage> ExpandStages(const SweepSource& source, const std::vector<Setting>& overrides,
                                const std::optional<WrittenCount>& missions);

}  // namespace ed3r
