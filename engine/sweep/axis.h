// Axes: what a sweep varies. All four forms become the same thing, a list of points that each set one or more
// parameters; the sweep is the cartesian product of its axes in the order written, the first one slowest.
//
//   agents.eta_min: [0.65, 0.75]                          grid: a point per value
//   radio.path_loss_exponent: {range: [3.0, 4.0, 0.2]}    grid: first, last, step; the last is included where met
//   zip:                                                  lockstep: point i sets all i-th values
//     robot.mass_kg: [1, 2]
//     robot.battery_mah: [3000, 4000]
//   list:                                                 points written out; names are optional
//     - {name: heavy, robot.mass_kg: 3}
//     - {robot.mass_kg: 1}
#pragma once

#include <string>
#include <vector>

#include "engine/sweep/setting.h"

namespace ed3r::sweep {

struct AxisPoint {
  std::string name;  // "" when it has none
  std::vector<Setting> settings;
  std::string at;
};

struct Axis {
  std::vector<AxisPoint> points;  // never empty
  std::string at;
};

// The axes of a `sweep` map, in the order written. Throws UserError.
std::vector<Axis> ReadAxes(const YamlNode& sweep, const SettingReader& reader);

// The values first, first + step, ... of [first, last, step] as text with no more decimals than `first` and
// `step` are written with, so that 3.0 + 3 x 0.2 is 3.6. `last` is included when it is met within rounding.
// `key` names the axis in messages.
std::vector<std::string> RangeValues(const YamlNode& range, const std::string& key);

// The first setting of a key on any of the axes, or null.
const Setting* FindOnAxes(const std::vector<Axis>& axes, std::string_view key);

// Refuses axes that set the same parameter, or both name airframe files: one would overwrite the other.
void CheckAxesDiffer(const std::vector<Axis>& axes);

}  // namespace ed3r::sweep
