// Do a log's numbers have the units that the fit takes them for? What cannot be is refused with what it looks like and
// the `units:` line of a format file that would mend it.
//
// A column for which the format has a units line is believed; only a climb rate that runs against the altitude is
// refused even so. Errors: UserError, one line that begins with the place. Threads: nothing is shared.
#pragma once

#include <string>
#include <vector>

#include "studies/fit/log_format.h"
#include "studies/flight_logs/log_table.h"

namespace ed3r::fit {

// The columns of `table` that are read as numbers: those of the format, and places, where CheckUnits looks at them.
std::vector<std::string> NumberColumns(const flight_logs::LogTable& table, const LogFormat& format);

// By the columns' names (speed_kmh, Speed [km h-1], time(ms)), the median step of the time, the size of speeds, loads, voltages and
// currents, and the speed against the path of latitude and longitude columns where there are any.
void CheckUnits(const flight_logs::LogTable& table, const LogFormat& format);

// Recorded climb rates of one flight and the slopes of its altitude at the same rows: `where` begins the message.
void CheckClimbAgainstAltitude(const std::string& where, const LogFormat& format,
                               const std::vector<double>& recorded_mps, const std::vector<double>& slope_mps);

}  // namespace ed3r::fit
