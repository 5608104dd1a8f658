// Rows on the ground that nobody left out: an idling robot takes a twentieth of what it takes in the air, so that a fit to
// both is a silently wrong number.
#pragma once

#include <vector>

#include "studies/fit/flight_log.h"
#include "studies/flight_logs/log_table.h"

namespace ed3r::fit {

// A run of rows is the ground where each takes less than kGroundShare of the log's upper quartile of power (the median could
// be the ground's own), within what the format calls hovering, for kGroundS and more.
inline constexpr double kGroundShare = 0.25;
inline constexpr double kGroundS = 5.0;
// Of a log's rows; fewer are to the robust fit what drop-outs are (the Matrice 100's log has 40 of 37,082, one landing).
inline constexpr double kLeastGroundPart = 0.01;

// Of logs whose format has no `in_flight` and in which no autopilot tells the ground. Throws UserError with the number of such
// rows and the line that leaves them out, unless they are few, or most rows of so little power are elsewhere: those are
// drop-outs.
void CheckGround(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log);

}  // namespace ed3r::fit
