// The same flight given twice: it would count as two, which narrows every interval, or judge a fit that has seen it.
#pragma once

#include "studies/fit/flight_log.h"

namespace ed3r::fit {

// Flights are the same where more than this share of one's rows has time, power and speed of rows of the other: copies,
// parts and joined files, but no flight that passes through the same numbers for a while.
inline constexpr double kSameShare = 0.5;

// Throws UserError that names both. `evaluated` may be null.
void CheckNoFlightTwice(const FlightLog& fitted, const FlightLog* evaluated);

}  // namespace ed3r::fit
