// A flight log of any kind that is known, told by its content: PX4 ULog, ArduPilot DataFlash, an AirData export, CSV.
#pragma once

#include <string>

#include "studies/flight_logs/log_table.h"

namespace ed3r::flight_logs {

// Throws UserError, one line that begins with the path.
LogTable ReadLog(const std::string& path, const LogReading& reading);
// The same from bytes; `path` only names them.
LogTable ParseLog(const std::string& path, std::string bytes, const LogReading& reading);

}  // namespace ed3r::flight_logs
