#include "engine/robot/airframe.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ed3r::robot {
namespace {

TEST(AirframeTest, DefaultsAreThePapersRobot) {
  const Airframe airframe{Config()};
  EXPECT_DOUBLE_EQ(airframe.WeightN(), 1.816 * 9.8);
  EXPECT_DOUBLE_EQ(airframe.ThrustMaxN(), 2 * 1.816 * 9.8);
  EXPECT_NEAR(airframe.inertia_kgm2.z(), 1.816 * (0.47 * 0.47 + 0.47 * 0.47) / 12, 1e-12);
  EXPECT_NEAR(airframe.inertia_kgm2.x(), 1.816 * (0.47 * 0.47 + 0.23 * 0.23) / 12, 1e-12);
  // Drag at 5 m/s: 0.5 rho A v^2 C.
  EXPECT_NEAR(airframe.DragN({5, 0, 0}).x(), -0.5 * 1.225 * 0.23 * 0.47 * 25 * 0.55, 1e-9);
  EXPECT_NEAR(airframe.DragN({0, 0, -5}).z(), 0.5 * 1.225 * 0.47 * 0.47 * 25 * 0.35, 1e-9);

  const FlightEnvelope envelope = EnvelopeOf(airframe, Config());
  EXPECT_EQ(envelope.horizontal.speed_mps, 5.0);
  EXPECT_EQ(envelope.horizontal.acceleration_mps2, 6.0);
  EXPECT_EQ(envelope.vertical.speed_mps, 5.0);
  EXPECT_EQ(envelope.vertical.acceleration_mps2, 6.0);
}

TEST(AirframeTest, EnvelopeShrinksToWhatTheRotorsCanDo) {
  Config light;
  light.robot.mass_kg = 0.05;
  EXPECT_LT(EnvelopeOf(Airframe(light), light).horizontal.speed_mps, 5.0);
  Config moon;
  moon.environment.gravity_mps2 = 1.6;
  EXPECT_LT(EnvelopeOf(Airframe(moon), moon).horizontal.acceleration_mps2, 1.6);
  Config windy;
  windy.environment.wind_x_mps = 12;
  windy.environment.gust_mps = 5;
  EXPECT_LT(EnvelopeOf(Airframe(windy), windy).horizontal.speed_mps, 5.0);
}

TEST(AirframeTest, SpeedKeepsTheBrakingWithinSight) {
  Config near_sighted;
  near_sighted.robot.speed_mps = 15.0;
  near_sighted.sensing.lidar_range_m = 10.0;
  const FlightEnvelope envelope = EnvelopeOf(Airframe(near_sighted), near_sighted);
  const double v = envelope.horizontal.speed_mps;
  const double a = envelope.horizontal.acceleration_mps2;
  EXPECT_LT(v * v / (2 * a) + HorizontalStandOffM(near_sighted.robot), 10.0);
  EXPECT_GT(v, 5.0);
  near_sighted.agents.obstacle_avoidance = false;
  EXPECT_EQ(EnvelopeOf(Airframe(near_sighted), near_sighted).horizontal.speed_mps, 15.0);
}

TEST(AirframeTest, RefusalsSayWhatIsAllowed) {
  EXPECT_EQ(CheckFlyable(Config()), "");
  Config config;
  config.robot.mass_kg = 0.05;
  config.environment.wind_x_mps = 9;
  EXPECT_EQ(
      CheckFlyable(config),
      "environment.wind_x_mps: '9' is not allowed; with robot.mass_kg = 0.05 and its drag the robot holds "
      "its place in at most 2.5 m/s, wind and gust together, not 9.0");
  config = Config();
  config.robot.safety_distance_m = 20;
  config.sensing.lidar_range_m = 15;
  EXPECT_EQ(
      CheckFlyable(config),
      "sensing.lidar_range_m: '15' is not allowed; with robot.safety_distance_m = 20 and the robot's size "
      "at least 22.4 m");
  config = Config();
  config.robot.height_m = 3;
  config.robot.width_m = 0.05;
  config.robot.depth_m = 0.05;
  EXPECT_EQ(
      CheckFlyable(config),
      "robot.height_m: '3' is not allowed; with robot.width_m = 0.05 and robot.depth_m = 0.05 the rotors "
      "turn the body too slowly to fly");
}

// It would be billed for a flight at another speed than it flies.
TEST(AirframeTest, ASpeedThatIsNotReachedIsRefused) {
  Config config;
  config.robot.speed_mps = 10;
  EXPECT_EQ(CheckFlyable(config), "");
  config.robot.drag_horizontal = 5;
  EXPECT_EQ(CheckFlyable(config),
            "robot.speed_mps: '10' is not allowed; across the robot flies at most 6.07 m/s against its drag "
            "(robot.drag_horizontal, drag_vertical) and the wind");
  config = Config();
  config.robot.speed_mps = 10;
  config.environment.wind_y_mps = 12;
  EXPECT_NE(CheckFlyable(config).find("across the robot flies at most 6."), std::string::npos);
  config = Config();
  config.robot.drag_vertical = 5;
  EXPECT_NE(CheckFlyable(config).find("up and down the robot flies at most 2.8"), std::string::npos);
  config = Config();
  config.robot.speed_mps = 10;
  config.sensing.lidar_range_m = 8;
  EXPECT_EQ(CheckFlyable(config),
            "robot.speed_mps: '10' is not allowed; across the robot flies at most 6.22 m/s to brake within "
            "sensing.lidar_range_m and robot.safety_distance_m");
  config.agents.obstacle_avoidance = false;
  EXPECT_EQ(CheckFlyable(config), "");
}

}  // namespace
}  // namespace ed3r::robot
