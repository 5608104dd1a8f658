// What surrounds the robot: gravity, air, wind, the radio link, and the operating point of `ed3r physics`.
#pragma once

#include "engine/config/field.h"

namespace ed3r {

struct EnvironmentConfig {
  double gravity_mps2 = 9.8;
  double air_density_kgm3 = 1.225;
  double wind_x_mps = 0.0;
  double wind_y_mps = 0.0;
  double gust_mps = 0.0;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit("gravity_mps2", self.gravity_mps2,
          {.unit = "m/s^2",
           .min = 1,
           .max = 30,
           .source = "Table UAV (a)",
           .meaning = "gravitational acceleration g"});
    visit("air_density_kgm3", self.air_density_kgm3,
          {.unit = "kg/m^3", .min = 0.3, .max = 2, .source = "R1", .meaning = "air density rho"});
    visit("wind_x_mps", self.wind_x_mps,
          {.unit = "m/s",
           .min = -12,
           .max = 12,
           .source = "none in the paper (A10)",
           .meaning = "mean wind towards east; billed with energy.model momentum, the paper's powers are of "
                      "still air"});
    visit("wind_y_mps", self.wind_y_mps,
          {.unit = "m/s",
           .min = -12,
           .max = 12,
           .source = "none in the paper (A10)",
           .meaning = "mean wind towards north; billed like wind_x_mps"});
    visit("gust_mps", self.gust_mps,
          {.unit = "m/s",
           .min = 0,
           .max = 5,
           .source = "none in the paper (A10)",
           .meaning = "standard deviation of gusts on each axis; flown, never billed"});
  }
};

// Wireless link between robot and RC (paper: Appendix, Achievable Data Rate Modeling; R10, R11).
struct RadioConfig {
  double target_dbm = -80.0;
  double power_min_dbm = 14.0;
  double power_max_dbm = 33.0;
  double carrier_hz = 2.4e9;
  double reference_m = 1.0;
  double path_loss_exponent = 3.8;
  double shadowing_sigma_db = 8.0;
  double bandwidth_min_hz = 15e6;
  double bandwidth_max_hz = 30e6;
  double efficiency_min = 0.12;
  double efficiency_max = 4.0;
  double noise_dbm_per_hz = -158.0;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kTable = "Table network";
    visit("target_dbm", self.target_dbm,
          {.unit = "dBm",
           .min = -130,
           .max = 0,
           .source = "Table network, R10",
           .meaning = "target signal strength tp_k"});
    visit("power_min_dbm", self.power_min_dbm,
          {.unit = "dBm",
           .min = -20,
           .max = 50,
           .source = "Table UAV (b)",
           .meaning = "lowest transmit power p_min"});
    visit("power_max_dbm", self.power_max_dbm,
          {.unit = "dBm",
           .min = -20,
           .max = 50,
           .source = "Table UAV (b)",
           .meaning = "highest transmit power p_max"});
    visit("carrier_hz", self.carrier_hz,
          {.unit = "Hz", .min = 1e8, .max = 1e11, .source = kTable, .meaning = "carrier frequency"});
    visit("reference_m", self.reference_m,
          {.unit = "m", .min = 0.1, .max = 100, .source = kTable, .meaning = "reference distance delta_0"});
    visit("path_loss_exponent", self.path_loss_exponent,
          {.min = 1.5, .max = 6, .source = kTable, .meaning = "path loss exponent e"});
    visit("shadowing_sigma_db", self.shadowing_sigma_db,
          {.unit = "dB",
           .min = 0,
           .max = 20,
           .source = "Table network, R10",
           .meaning = "standard deviation of shadow fading"});
    visit("bandwidth_min_hz", self.bandwidth_min_hz,
          {.unit = "Hz",
           .min = 1e5,
           .max = 1e9,
           .source = "Table network, R11",
           .meaning = "b_k is uniform from here ..."});
    visit("bandwidth_max_hz", self.bandwidth_max_hz,
          {.unit = "Hz", .min = 1e5, .max = 1e9, .source = "Table network, R11", .meaning = "... to here"});
    visit("efficiency_min", self.efficiency_min,
          {.unit = "bit/s/Hz",
           .min = 0.001,
           .max = 20,
           .source = "Table network, R11",
           .meaning = "lowest spectral efficiency se_min"});
    visit("efficiency_max", self.efficiency_max,
          {.unit = "bit/s/Hz",
           .min = 0.001,
           .max = 20,
           .source = "Table network, R11",
           .meaning = "highest spectral efficiency se_max"});
    visit("noise_dbm_per_hz", self.noise_dbm_per_hz,
          {.unit = "dBm/Hz",
           .min = -200,
           .max = -50,
           .source = kTable,
           .meaning = "noise spectral density N_0"});
  }
};

}  // namespace ed3r
