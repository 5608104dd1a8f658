// Which of a raw log's batteries a fit takes.
#pragma once

#include <string>
#include <vector>

#include "studies/flight_logs/log_table.h"
#include "studies/flight_logs/time_series.h"

namespace ed3r::flight_logs {

struct Battery {
  int id = 0;
  std::string source;               // "BAT instance 0", "battery_status 1"
  TimeSeries voltage_v, current_a;  // of the same stamps
};

struct ChosenBattery {
  std::vector<double> times_s, voltage_v, current_a;
  std::string note;
};

// The battery of LogReading::battery; without one, the only battery that measured a current. Of all batteries together,
// the clock and voltage are the first's, and the current is the sum of powers over that voltage.
// Throws UserError: no battery, no current that is above 0, several batteries and no choice, no battery of that number.
ChosenBattery ChooseBattery(const std::string& path, const std::vector<Battery>& batteries,
                            const LogReading& reading);

// Refuses a log in which no battery measured a current. Apart, because that is the first thing to say of a log.
void CheckPowerMeasured(const std::string& path, const std::vector<Battery>& batteries);

}  // namespace ed3r::flight_logs
