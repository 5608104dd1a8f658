// How the columns of a telemetry log map to what the fit needs. Four formats are built in (m100, ardupilot, px4, dji);
// others are YAML files, described with an example in sweeps/OWN_DATA.md:
//
//   columns:                       # meaning -> name in the log's header
//     time_s: time
//     power_w: power               # or voltage_v and current_a
//     airspeed_mps: airspeed       # or ground_speed_mps, taken as airspeed (calm air)
//     climb_mps: vertspd           # upwards positive; needed unless climb_from is altitude
//     altitude_m: diffalt          # needed when climb_from is altitude
//     flight: flight               # optional: flights of one file; without it a file is one flight
//     air_density_kgm3: density    # optional: else air_density_kgm3 below
//     payload_kg: payload          # optional: added to robot.mass_kg; or mass_kg, the whole mass
//   units: {climb_mps: 0.01}       # optional factors from the log's unit, here cm/s
//   climb_from: altitude           # column (default) | altitude: slope of the altitude over +-climb_window_s
//   climb_window_s: 1.2
//   air_density_kgm3: 1.225
//   in_flight: {throttle: 100, state: [flying, landing]}   # rows count only where each of these columns is at least
//                                                          # the number, or is one of the words
//   hover: {max_speed_mps: 3, max_climb_mps: 0.4}   # what counts as hovering; wide enough for wind on an anemometer
//   robot: {mass_kg: 3.68, ...}    # any robot.* parameter: the airframe that flew
//   notes: [text, ...]             # repeated in the report
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/config/robot.h"

namespace ed3r::fit {

enum class ClimbFrom { kColumn, kAltitude };

// What a column must say for a row to count as flown.
struct FlightCondition {
  double least = 0.0;
  std::vector<std::string> words;  // where there are any, the cell is one of them, in whatever case
};

struct LogFormat {
  std::string name;
  std::map<std::string, std::string> columns;
  std::map<std::string, double> units;
  ClimbFrom climb_from = ClimbFrom::kColumn;
  double climb_window_s = 1.2;
  double air_density_kgm3 = 1.225;
  std::map<std::string, FlightCondition> in_flight;
  double hover_max_speed_mps = 3.0;
  double hover_max_climb_mps = 0.4;
  RobotConfig robot;
  std::set<std::string> robot_keys;  // those of `robot` that somebody named; all others are the paper's Iris
  std::vector<std::string> notes;

  bool Has(const std::string& meaning) const { return columns.contains(meaning); }
};

// A built-in name or the path of a YAML file. Throws UserError (file:line:column) for unknown names or keys,
// wrong types, values out of range, or a map from which no power, speed or climb rate can be had.
LogFormat LoadLogFormat(const std::string& name_or_path);
LogFormat ParseLogFormat(const std::string& name, const std::string& yaml);

std::vector<std::string> BuiltInLogFormats();
bool IsBuiltInLogFormat(const std::string& name);

}  // namespace ed3r::fit
