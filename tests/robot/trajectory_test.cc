#include "engine/robot/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/random.h"

namespace ed3r::robot {
namespace {

constexpr double kTiny = 1e-9;

MotionLimits Limits(double speed, double acceleration, double jerk, double smoothing_s) {
  return {
      .speed_mps = speed, .acceleration_mps2 = acceleration, .jerk_mps3 = jerk, .smoothing_s = smoothing_s};
}

// Walks a profile in small steps and checks that nothing jumps and nothing exceeds its limit. `jerk_factor`:
// the last letting-go of a braking may need more jerk than the limit.
void ExpectWithinLimits(const Profile& profile, const MotionLimits& limits, double jerk_factor = 1.0) {
  const double step_s = 1e-3;
  ProfilePoint last = profile.At(0.0);
  EXPECT_EQ(last.position, 0.0);
  for (double t = step_s; t < profile.DurationS() + 0.1; t += step_s) {
    const ProfilePoint now = profile.At(t);
    ASSERT_GE(now.position, last.position - kTiny) << t;
    ASSERT_GE(now.speed, -1e-6) << t;
    ASSERT_LE(now.speed, limits.speed_mps + 1e-6) << t;
    ASSERT_LE(std::abs(now.acceleration), limits.acceleration_mps2 + 1e-6) << t;
    ASSERT_LE(std::abs(now.jerk), jerk_factor * limits.jerk_mps3 + 1e-6) << t;
    ASSERT_NEAR(now.position - last.position, 0.5 * step_s * (now.speed + last.speed), 1e-5) << t;
    ASSERT_NEAR(now.speed - last.speed, 0.5 * step_s * (now.acceleration + last.acceleration), 1e-4) << t;
    ASSERT_EQ(profile.SnapAt(t), now.snap) << t;
    last = now;
  }
  EXPECT_EQ(last.position, profile.Length());
  EXPECT_EQ(last.speed, 0.0);
}

TEST(ProfileTest, LongLegTakesTheTimeOfItsParts) {
  const MotionLimits limits = Limits(5, 6, 40, 0.15);
  const Profile profile(20.0, limits);
  // Cruise, one ramp up and down together, the build-up of the acceleration, the smoothing.
  EXPECT_NEAR(profile.DurationS(), 20.0 / 5 + 5.0 / 6 + 6.0 / 40 + 0.15, kTiny);
  EXPECT_EQ(profile.Length(), 20.0);
}

TEST(ProfileTest, RandomLegsKeepTheirLimits) {
  Stream draw(1, 0, Purpose::kMotion);
  for (int i = 0; i < 60; ++i) {
    const MotionLimits limits =
        Limits(draw.Uniform(0.5, 15), draw.Uniform(0.5, 8), draw.Uniform(3, 90), draw.Uniform(0.02, 0.3));
    const double length = std::pow(10.0, draw.Uniform(-2.5, 1.8));
    SCOPED_TRACE(length);
    ExpectWithinLimits(Profile(length, limits), limits);
  }
}

TEST(ProfileTest, NoLengthIsNoMotion) {
  const Profile profile(0.0, Limits(5, 6, 40, 0.15));
  EXPECT_EQ(profile.DurationS(), 0.0);
  EXPECT_EQ(profile.At(0.1).position, 0.0);
  EXPECT_EQ(Profile().DurationS(), 0.0);
}

TEST(ProfileTest, SmoothedMotionIsTheMeanOfTheFront) {
  const MotionLimits limits = Limits(5, 6, 40, 0.15);
  const Profile profile(7.0, limits);
  for (double t : {0.05, 0.2, 0.7, 1.3, 2.0}) {
    double mean = 0.0;
    const int n = 2000;
    for (int i = 0; i < n; ++i) mean += profile.FrontAt(t - 0.15 * (i + 0.5) / n).position / n;
    EXPECT_NEAR(profile.At(t).position, mean, 1e-6) << t;
  }
}

TEST(ProfileTest, BrakingEndsWhereItWasPredictedAndKeepsTheLimits) {
  Stream draw(2, 0, Purpose::kMotion);
  for (int i = 0; i < 200; ++i) {
    const MotionLimits limits = Limits(draw.Uniform(1, 10), draw.Uniform(1, 8), draw.Uniform(5, 90), 0.1);
    Profile profile(draw.Uniform(0.05, 30), limits);
    const double full_length = profile.Length();
    const double time_s = draw.Uniform(0.0, profile.DurationS());
    SCOPED_TRACE(time_s);
    const ProfilePoint front = profile.FrontAt(time_s);
    const double predicted = front.position + profile.BrakingDistance(front);
    const bool ended = time_s >= profile.DurationS() - limits.smoothing_s;
    profile.BrakeAt(time_s);
    EXPECT_NEAR(profile.Length(), predicted, 1e-9);
    EXPECT_LE(profile.Length(), full_length + 1e-9);
    // Braking started in the last letting-go adds no jerk; rounding there may ask for a little more.
    if (!ended) ExpectWithinLimits(profile, limits, 1.001);
  }
}

TEST(ProfileTest, BrakingFromCruiseTakesTheKnownDistance) {
  const MotionLimits limits = Limits(5, 6, 40, 0.15);
  const Profile profile(30.0, limits);
  const ProfilePoint cruise = profile.FrontAt(3.0);
  ASSERT_NEAR(cruise.speed, 5.0, kTiny);
  EXPECT_NEAR(profile.BrakingDistance(cruise), 25.0 / 12 + 5.0 * 6 / (2 * 40), 1e-9);
}

}  // namespace
}  // namespace ed3r::robot
