#include "engine/robot/rotors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/random.h"

namespace ed3r::robot {
namespace {

constexpr double kStepS = 1.0 / 240.0;

TEST(RotorsTest, MixedThrustsGiveTheWrenchBack) {
  const Airframe airframe{Config()};
  Stream draw(3, 0, Purpose::kMotion);
  for (int i = 0; i < 100; ++i) {
    const Wrench wanted = {draw.Uniform(0.8, 1.2) * airframe.WeightN(),
                           {draw.Uniform(-0.5, 0.5), draw.Uniform(-0.5, 0.5), draw.Uniform(-0.05, 0.05)}};
    const Wrench got = WrenchOf(airframe, Mix(airframe, wanted));
    EXPECT_NEAR(got.thrust_n, wanted.thrust_n, 1e-9);
    EXPECT_NEAR((got.torque_nm - wanted.torque_nm).norm(), 0.0, 1e-9);
  }
}

TEST(RotorsTest, RollAndPitchComeFirstThenThrustThenYaw) {
  const Airframe airframe{Config()};
  // Full thrust and a roll: thrust gives way until the roll fits, yaw gets nothing.
  const Wrench got = WrenchOf(airframe, Mix(airframe, {airframe.ThrustMaxN(), {1.0, 0.0, 0.1}}));
  EXPECT_NEAR(got.torque_nm.x(), 1.0, 1e-9);
  EXPECT_LT(got.thrust_n, airframe.ThrustMaxN());
  EXPECT_NEAR(got.torque_nm.z(), 0.0, 1e-9);
  // No thrust and a pitch: thrust rises until the pitch fits.
  const Wrench low = WrenchOf(airframe, Mix(airframe, {0.0, {0.0, 1.0, 0.0}}));
  EXPECT_NEAR(low.torque_nm.y(), 1.0, 1e-9);
  EXPECT_GT(low.thrust_n, 0.0);
}

TEST(RotorsTest, ThrustsStayWithinTheirLimits) {
  const Airframe airframe{Config()};
  Stream draw(4, 0, Purpose::kMotion);
  for (int i = 0; i < 1000; ++i) {
    const Wrench wanted = {draw.Uniform(-1, 3) * airframe.WeightN(),
                           {draw.Uniform(-20, 20), draw.Uniform(-20, 20), draw.Uniform(-2, 2)}};
    for (double thrust_n : Mix(airframe, wanted)) {
      EXPECT_GE(thrust_n, 0.0);
      EXPECT_LE(thrust_n, airframe.rotor_thrust_max_n);
    }
  }
}

// Steps until 63 % of a change of thrust has happened.
int StepsTo63Percent(double from_n, double to_n) {
  const Airframe airframe{Config()};
  Rotors rotors(airframe, kStepS);
  rotors.Settle({from_n, Eigen::Vector3d::Zero()});
  for (int step = 1; step < 1000; ++step) {
    const double thrust_n = rotors.Step({to_n, Eigen::Vector3d::Zero()}).thrust_n;
    if (std::abs(thrust_n - from_n) >= 0.632 * std::abs(to_n - from_n)) return step;
  }
  return 1000;
}

TEST(RotorsTest, SmallChangesFollowFastAndLargeOnesAtTheMotorsPace) {
  const double weight_n = Airframe{Config()}.WeightN();
  EXPECT_NEAR(StepsTo63Percent(weight_n, 1.05 * weight_n) * kStepS, kRotorLagS, 0.005);
  EXPECT_NEAR(StepsTo63Percent(0.0, 2.0 * weight_n) * kStepS, kMotorLagS, 0.006);
}

}  // namespace
}  // namespace ed3r::robot
