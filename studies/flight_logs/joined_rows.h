// Sources on a battery's clock, to the rows of a DecodedLog.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "studies/flight_logs/battery.h"
#include "studies/flight_logs/log_table.h"
#include "studies/flight_logs/time_series.h"

namespace ed3r::flight_logs {

struct NamedSeries {
  std::string name;
  const TimeSeries* series;
};

// One row per battery sample, each series by TimeSeries::Nearest; rows in which a series has no value near are left out
// and counted in a note. `armed` and `landed` (1 or 0) tell rows on the ground; an empty series tells nothing.
DecodedLog JoinRows(const std::string& path, LogKind kind, const ChosenBattery& battery,
                    const std::vector<NamedSeries>& series, const TimeSeries& armed,
                    const TimeSeries& landed);

// Refuses a log that is in the air for less than a motor test takes, by the battery's clock; said before whatever else the
// log lacks.
void CheckAnyFlight(const std::string& path, const TimeSeries& clock, const TimeSeries& armed,
                    const TimeSeries& landed);

// The battery that a fit takes of a log's, by their numbers. What is wrong is said in this order: no power measured
// (CheckPowerMeasured), no flight (CheckAnyFlight), no such battery or no choice (ChooseBattery).
ChosenBattery BatteryInFlight(const std::string& path, const std::map<int, Battery>& batteries,
                              const TimeSeries& armed, const TimeSeries& landed, const LogReading& reading);

// Refuses rows of which none is in the air.
void CheckFlown(const DecodedLog& log);

}  // namespace ed3r::flight_logs
