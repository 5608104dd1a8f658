// A DJI flight as the AirData service exports it (CSV), as a table in SI units.
//
//   time_s                from time(millisecond)
//   battery_voltage_v, battery_current_a   voltage(v), current(A)
//   ground_speed_mps      speed
//   climb_mps             -zSpeed: DJI counts it downwards
//   altitude_m            height_above_takeoff
//
// Imperial and metric exports are told by the units in the header. On the ground: flycState says that the motors start,
// or the height above take-off is below 0.5 m.
#pragma once

#include "engine/core/files/csv_table.h"
#include "studies/flight_logs/log_table.h"

namespace ed3r::flight_logs {

bool IsAirDataLog(const CsvTable& table);

// Throws UserError: a column that is missing or has a unit that is not known, bad cells (with skip_bad: left out and
// counted), no current, no flight. `bad`: rows that were left out before. In `table`, decimal
// commas become points.
DecodedLog ReadAirDataLog(CsvTable& table, const LogReading& reading, int bad);

}  // namespace ed3r::flight_logs
