// The same flight given twice: it would count as two, which narrows every interval, or judge a fit that has seen it.
#pragma once

#include "studies/fit/flight_log.h"

namespace ed3r::fit {

// Flights are the same where more than this share of one's rows has time, power and speed of rows of the other: copies,
// parts and joined files, but no flight that passes through the same numbers for a while. Times are the same within half a
// step, as they are or from each flight's first row: a copy's clock may start at 0, and its stamps be rounded.
inline constexpr double kSameShare = 0.5;

// Throws UserError that names both. `evaluated` may be null.
void CheckNoFlightTwice(const FlightLog& fitted, const FlightLog* evaluated);

}  // namespace ed3r::fit
