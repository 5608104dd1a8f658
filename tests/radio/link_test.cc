#include "engine/radio/link.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ed3r::radio {
namespace {

// EVIDENCE of the readings: L_0 = 40.05 dB at 2.4 GHz and 1 m.
TEST(LinkTest, ReferenceLoss) {
  EXPECT_NEAR(EvaluateLink(RadioConfig(), 1.0, 20e6, 0.0).path_loss_db, 40.05, 0.005);
}

TEST(LinkTest, DistanceBelowReferenceCountsAsReference) {
  EXPECT_EQ(EvaluateLink(RadioConfig(), 0.0, 20e6, 0.0).path_loss_db,
            EvaluateLink(RadioConfig(), 1.0, 20e6, 0.0).path_loss_db);
}

// Between about 26 m and 83 m power control is free of its limits, so that the received level is the target.
TEST(LinkTest, PowerControlReachesTheTargetWithinItsLimits) {
  const RadioConfig radio;
  for (double distance_m : {30.0, 60.0, 80.0}) {
    const Link link = EvaluateLink(radio, distance_m, 22.5e6, 0.0);
    EXPECT_NEAR(link.transmit_power_dbm - link.path_loss_db, radio.target_dbm, 1e-9);
  }
  EXPECT_EQ(EvaluateLink(radio, 5.0, 22.5e6, 0.0).transmit_power_dbm, radio.power_min_dbm);
  EXPECT_EQ(EvaluateLink(radio, 200.0, 22.5e6, 0.0).transmit_power_dbm, radio.power_max_dbm);
}

TEST(LinkTest, ShadowingIsNotCompensated) {
  const Link clear = EvaluateLink(RadioConfig(), 60.0, 22.5e6, 0.0);
  const Link shadowed = EvaluateLink(RadioConfig(), 60.0, 22.5e6, 10.0);
  EXPECT_EQ(clear.transmit_power_w, shadowed.transmit_power_w);
  EXPECT_NEAR(clear.signal_to_noise / shadowed.signal_to_noise, 10.0, 1e-9);
}

// The whole budget by hand, where nothing is at a limit and no factor is 1.
TEST(LinkTest, TheBudgetByHand) {
  RadioConfig radio;
  radio.reference_m = 2.0;
  const Link link = EvaluateLink(radio, 60.0, 22.5e6, 3.0);
  const double loss_db =
      20 * std::log10(4 * 3.14159265358979 * 2.0 * 2.4e9 / 299792458.0) + 38 * std::log10(30.0);
  const double sent_w = std::pow(10.0, (-80.0 + loss_db - 30) / 10), noise_w = 22.5e6 * std::pow(10.0, -18.8);
  const double signal_to_noise = sent_w * std::pow(10.0, -(loss_db + 3) / 10) / noise_w;
  EXPECT_NEAR(link.path_loss_db, loss_db, 1e-9);
  EXPECT_NEAR(link.transmit_power_w, sent_w, 1e-9 * sent_w);
  EXPECT_NEAR(link.signal_to_noise, signal_to_noise, 1e-9 * signal_to_noise);
  EXPECT_NEAR(link.rate_bps, 22.5e6 * std::log2(1 + signal_to_noise), 1e-3);
}

TEST(LinkTest, EfficiencyStaysInItsBand) {
  const RadioConfig radio;
  EXPECT_EQ(EvaluateLink(radio, 400.0, 20e6, 0.0).rate_bps, 20e6 * radio.efficiency_min);
  EXPECT_EQ(EvaluateLink(radio, 2.0, 20e6, 0.0).rate_bps, 20e6 * radio.efficiency_max);
  EXPECT_EQ(LargestRateBps(radio), 120e6);
}

TEST(LinkTest, TransmissionOfOneSensingPeriod) {
  const Link link = EvaluateLink(RadioConfig(), 400.0, 22.5e6, 0.0);
  const double payload_byte = 33 * 519000.0;
  EXPECT_NEAR(TransmissionTimeS(payload_byte, link), 50.7, 0.05);  // the floor rate (A29)
  EXPECT_NEAR(TransmissionEnergyJ(payload_byte, link),
              std::pow(10.0, 0.3) * TransmissionTimeS(payload_byte, link), 1e-9);
}

}  // namespace
}  // namespace ed3r::radio
