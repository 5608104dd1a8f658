// An ArduPilot DataFlash log as a table: a row for each battery sample in which all other values are near in time.
//
//   time_s                          board time
//   battery_voltage_v, battery_current_a   BAT or CURR
//   ground_speed_mps, gps_climb_mps GPS (Spd, -VZ) while its fix is 3-D; where a log has no such fix, the estimator's
//   estimator_speed_mps, estimator_climb_mps   XKF1, NKF1 or EKF1 (VN, VE, -VD) where the log has them
//   altitude_m                      CTUN.Alt, else BARO.Alt: above the place of arming
//   throttle_0_1000                 CURR.Throttle, CTUN.ThrOut or 1000 CTUN.ThO
//
// On the ground: disarmed or landed by ARM and EV messages.
#pragma once

#include <string>
#include <string_view>

#include "studies/flight_logs/log_table.h"

namespace ed3r::flight_logs {

// Throws UserError: what DataFlashLog refuses; no power, speed or altitude in the log; a choice of batteries to make.
DecodedLog ReadArduPilotLog(const std::string& path, std::string_view bytes, const LogReading& reading);

}  // namespace ed3r::flight_logs
