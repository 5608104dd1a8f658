// A PX4 ULog as a table: a row for each sample of battery_status in which all other values are near in time.
//
//   time_s                          seconds since the board started
//   battery_voltage_v, battery_current_a   battery_status
//   ground_speed_mps, climb_mps     the estimator's: vehicle_local_position vx, vy, -vz while it says that they are valid
//   altitude_m                      -z: above the place where the estimator began
//   air_density_kgm3                vehicle_air_data.rho, where the log has it
//
// On the ground: not armed (actuator_armed) or landed (vehicle_land_detected).
#pragma once

#include <string>
#include <string_view>

#include "studies/flight_logs/log_table.h"

namespace ed3r::flight_logs {

// Throws UserError: what ULog refuses; no power, no velocity, no flight in the log; a choice of batteries to make.
DecodedLog ReadPx4Log(const std::string& path, std::string_view bytes, const LogReading& reading);

}  // namespace ed3r::flight_logs
