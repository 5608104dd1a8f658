#include "engine/radio/link.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ed3r::radio {
namespace {

constexpr double kLightSpeedMps = 299792458.0;

double WattFromDbm(double dbm) { return std::pow(10.0, (dbm - 30.0) / 10.0); }

double ReferenceLossDb(const RadioConfig& radio) {
  return 20.0 * std::log10(radio.reference_m) + 20.0 * std::log10(radio.carrier_hz) +
         20.0 * std::log10(4.0 * std::numbers::pi / kLightSpeedMps);
}

}  // namespace

Link EvaluateLink(const RadioConfig& radio, double distance_m, double bandwidth_hz, double shadowing_db) {
  Link link;
  const double distance_ratio = std::max(distance_m / radio.reference_m, 1.0);
  link.path_loss_db = ReferenceLossDb(radio) + 10.0 * radio.path_loss_exponent * std::log10(distance_ratio);
  link.transmit_power_dbm =
      std::clamp(radio.target_dbm + link.path_loss_db, radio.power_min_dbm, radio.power_max_dbm);
  link.transmit_power_w = WattFromDbm(link.transmit_power_dbm);
  const double gain = std::pow(10.0, -(link.path_loss_db + shadowing_db) / 10.0);  // g_k
  const double noise_w = bandwidth_hz * WattFromDbm(radio.noise_dbm_per_hz);
  link.signal_to_noise = gain * link.transmit_power_w / noise_w;
  link.efficiency_bps_hz =
      std::clamp(std::log2(1.0 + link.signal_to_noise), radio.efficiency_min, radio.efficiency_max);
  link.rate_bps = bandwidth_hz * link.efficiency_bps_hz;
  return link;
}

double LargestRateBps(const RadioConfig& radio) { return radio.bandwidth_max_hz * radio.efficiency_max; }

double TransmissionTimeS(double payload_byte, const Link& link) { return 8.0 * payload_byte / link.rate_bps; }

double TransmissionEnergyJ(double payload_byte, const Link& link) {
  return link.transmit_power_w * TransmissionTimeS(payload_byte, link);
}

}  // namespace ed3r::radio
