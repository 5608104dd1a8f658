// Can the power of a log have been measured on the airframe that is said to have flown?
#pragma once

#include <vector>

#include "studies/fit/flight_log.h"

namespace ed3r::fit {

// Hover power over the ideal induced power (m g)^1.5 / sqrt(2 rho A): below 1 no rotor can be; above kMaxIdeal the
// paper's model has no efficiency left (its lower bound is 0.05).
inline constexpr double kMaxIdealRatio = 20.0;

// Throws UserError: a power that does not vary, hover power below the ideal or far above it, with the units line that
// would mend it where a factor does. Logs without hovering rows are not compared with the ideal.
void CheckMeasuredPower(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log,
                        double gravity_mps2);

}  // namespace ed3r::fit
