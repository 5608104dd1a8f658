// What an arm is called in results, tables and figures.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "engine/config/config.h"
#include "engine/sweep/axis.h"
#include "engine/sweep/plan.h"

namespace ed3r::sweep {

// The name of the arm at one point of each axis: the points' parts, joined by commas. A named point of a
// `list` gives its name, which stands for all that it sets. Any other setting gives "key=value", with the
// last part of the key where that is unambiguous among the axes, and a file without its folder and ending. The
// strategy comes first: random is "warmup", ed3r is "ed3r-75" with eta_min in percent, others their own name; it
// is left out where a list names the points and no axis of its own varies it. A training stage that varies no
// strategy has its own name there.
//   rbs    ed3r-75    rbs,path_loss_exponent=3.2    rbs,light    training,eta_min=0.65
// `axis_keys` are the keys that the stage's axes set.
std::string ArmName(const Stage& stage, const Config& config, const std::vector<const AxisPoint*>& points,
                    const std::set<std::string>& axis_keys);

// What the top-level axes of a sweep with stages say at one point of each: as above, but the strategy is told like any
// other setting. Arms of such a sweep are called ARM@VARIANT.
//   ed3r-75@hover_form=printed    warmup@heavy
std::string VariantName(const std::vector<const AxisPoint*>& points, const std::set<std::string>& axis_keys);

}  // namespace ed3r::sweep
