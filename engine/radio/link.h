// Link budget of the robot's uplink (paper: Appendix, Achievable Data Rate Modeling; R10, R11).
#pragma once

#include "engine/config/environment.h"

namespace ed3r::radio {

struct Link {
  double path_loss_db = 0.0;  // L_0 + 10 e log10(delta / delta_0), without shadowing
  double transmit_power_dbm =
      0.0;  // p_k: reaches the target level over the path loss, within the radio's limits
  double transmit_power_w = 0.0;
  double signal_to_noise = 0.0;    // linear
  double efficiency_bps_hz = 0.0;  // log2(1 + SNR) within [se_min, se_max]
  double rate_bps = 0.0;           // d_k
};

// distance_m is 3-D and counts as at least the reference distance; shadowing_db adds to the path loss and is not
// compensated by power control.
Link EvaluateLink(const RadioConfig& radio, double distance_m, double bandwidth_hz, double shadowing_db);

// Largest rate that the radio can have, b_max se_max: the denominator of RBS's transmission ratio (R25).
double LargestRateBps(const RadioConfig& radio);

// Eqs. 8 and 9.
double TransmissionTimeS(double payload_byte, const Link& link);
double TransmissionEnergyJ(double payload_byte, const Link& link);

}  // namespace ed3r::radio
