#include "engine/robot/flight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "tests/world/scene_builder.h"

namespace ed3r::robot {
namespace {

const world::Scene& OpenSky() {
  static const world::Scene scene(world::PartsOf(54, 10.0, [](double, double) { return 0.0; }));
  return scene;
}

Pose PoseAt(double x_m, double y_m, double z_m, double yaw_rad = 0.0) {
  return {.position_m = {x_m, y_m, z_m}, .yaw_rad = yaw_rad, .tilt_rad = 0.2};
}

MotionCommand Move(double dx_m, double dy_m, double dz_m, double turn_rad = 0.0) {
  return {.displacement_m = {dx_m, dy_m, dz_m}, .turn_rad = turn_rad, .tilt_rad = 0.5};
}

struct Recorder : TraceSink {
  std::vector<TraceSample> samples;
  void Record(const TraceSample& sample) override { samples.push_back(sample); }
};

FlownMove FlyOnce(const Config& config, const MotionCommand& command, TraceSink* sink = nullptr) {
  Flight flight(OpenSky(), config, PoseAt(265, 265, 60), 1, 0);
  flight.SetTrace(sink);
  return flight.Execute(command, 1);
}

// Bills the times that were flown (R4), which most of these tests are about.
Config FlownTimes() {
  Config config;
  config.energy.move_time = MoveTime::kFlown;
  return config;
}

double NominalLegS(double length_m, double speed_mps = 5.0, double acceleration_mps2 = 6.0) {
  const double ramp_m = speed_mps * speed_mps / acceleration_mps2;
  return length_m >= ramp_m ? length_m / speed_mps + speed_mps / acceleration_mps2
                            : 2.0 * std::sqrt(length_m / acceleration_mps2);
}

TEST(FlightTest, ZeroAndHoverCommandsTakeNoTimeAndNoPhysics) {
  Flight flight(OpenSky(), FlownTimes(), PoseAt(265, 265, 60, 0.3), 1, 0);
  MotionCommand hover = Move(5, 5, 5, 1.0);
  hover.hover = true;
  for (const MotionCommand& command : {Move(0, 0, 0), hover}) {
    const FlownMove move = flight.Execute(command, 1);
    EXPECT_EQ(move.end.position_m, Eigen::Vector3d(265, 265, 60));
    EXPECT_EQ(move.end.yaw_rad, 0.3);
    EXPECT_EQ(move.horizontal_s + move.ascent_s + move.descent_s + move.hovering_s, 0.0);
    EXPECT_EQ(move.distance_m, 0.0);
    EXPECT_FALSE(move.halted);
  }
  EXPECT_EQ(flight.PhysicsSteps(), 0);
}

TEST(FlightTest, TheStepOfThePhysicsHardlyMovesALeg) {
  const MotionCommand command = Move(25, -10, 8, 1.2);
  Config config = FlownTimes();
  const FlownMove usual = FlyOnce(config, command);
  const double usual_hz = config.mission.physics_hz;
  for (const double hz : {240.0, 480.0, 960.0}) {
    config.mission.physics_hz = hz;
    Flight flight(OpenSky(), config, PoseAt(265, 265, 60), 1, 0);
    const FlownMove move = flight.Execute(command, 1);
    EXPECT_LT((move.end.position_m - usual.end.position_m).norm(), 0.06) << hz;
    EXPECT_NEAR(move.horizontal_s, usual.horizontal_s, 2.5 / usual_hz + 0.01 * usual.horizontal_s) << hz;
    EXPECT_NEAR(move.distance_m, usual.distance_m, 0.005 * usual.distance_m) << hz;
    const double steps = (move.horizontal_s + move.ascent_s + move.descent_s + move.hovering_s) * hz;
    EXPECT_NEAR(static_cast<double>(flight.PhysicsSteps()), steps, 0.5) << hz;
  }
}

TEST(FlightTest, LegsEndOnTargetWithinAThirdOfASecondOfTheIdealTime) {
  for (const double length_m : {0.5, 1.0, 3.0, 8.0, 20.0, 28.0}) {
    for (const double heading : {0.0, 0.8, 2.5, -1.9}) {
      const Eigen::Vector3d way = length_m * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0);
      const FlownMove move = FlyOnce(FlownTimes(), Move(way.x(), way.y(), 0));
      EXPECT_NEAR((move.end.position_m - Eigen::Vector3d(265, 265, 60) - way).norm(), 0.0, 0.05);
      EXPECT_GT(move.horizontal_s, NominalLegS(length_m));
      EXPECT_LT(move.horizontal_s, NominalLegS(length_m) + 0.34) << length_m;
      EXPECT_EQ(move.ascent_s + move.descent_s + move.hovering_s, 0.0);
      EXPECT_NEAR(move.distance_m, length_m, 0.06);
      EXPECT_EQ(move.contact_steps, 0);
    }
    for (const double sign : {-1.0, 1.0}) {
      const FlownMove move = FlyOnce(FlownTimes(), Move(0, 0, sign * length_m));
      const double flown_s = sign > 0 ? move.ascent_s : move.descent_s;
      EXPECT_NEAR((move.end.position_m - Eigen::Vector3d(265, 265, 60 + sign * length_m)).norm(), 0.0, 0.05);
      EXPECT_LT(flown_s, NominalLegS(length_m) + 0.34);
      EXPECT_EQ(move.horizontal_s + (sign > 0 ? move.descent_s : move.ascent_s), 0.0);
    }
  }
}

TEST(FlightTest, FliesHorizontalThenVerticalOrTheOtherWayRound) {
  for (const bool vertical_first : {false, true}) {
    Config config = FlownTimes();
    if (vertical_first) config.energy.move_order = MoveOrder::kVerticalFirst;
    Recorder recorder;
    const FlownMove move = FlyOnce(config, Move(12, -9, -10), &recorder);
    EXPECT_NEAR((move.end.position_m - Eigen::Vector3d(277, 256, 50)).norm(), 0.0, 0.05);
    EXPECT_NEAR(move.horizontal_s, NominalLegS(15) + 0.3, 0.05);
    EXPECT_NEAR(move.descent_s, NominalLegS(10) + 0.2, 0.1);
    EXPECT_EQ(move.ascent_s, 0.0);
    const double first_s = vertical_first ? move.descent_s : move.horizontal_s;
    const auto at_turn = std::find_if(recorder.samples.begin(), recorder.samples.end(),
                                      [&](const TraceSample& s) { return s.time_s >= first_s; });
    ASSERT_NE(at_turn, recorder.samples.end());
    const Eigen::Vector3d corner =
        vertical_first ? Eigen::Vector3d(265, 265, 50) : Eigen::Vector3d(277, 256, 60);
    EXPECT_NEAR((at_turn->position_m - corner).norm(), 0.0, 0.1);
  }
}

TEST(FlightTest, TraceRunsFromStartToEndAndKeepsTheLimits) {
  Recorder recorder;
  const FlownMove move = FlyOnce(FlownTimes(), Move(20, 10, 8, 1.0), &recorder);
  const std::vector<TraceSample>& samples = recorder.samples;
  const double total_s = move.horizontal_s + move.ascent_s + move.hovering_s;
  ASSERT_NEAR(static_cast<double>(samples.size()), total_s * kTraceHz, 3.0);
  EXPECT_NEAR((samples.front().position_m - Eigen::Vector3d(265, 265, 60)).norm(), 0.0, 1e-4);
  EXPECT_EQ(samples.front().time_s, 0.0);
  EXPECT_EQ(samples.back().position_m, move.end.position_m);
  EXPECT_EQ(samples.back().yaw_rad, move.end.yaw_rad);
  EXPECT_NEAR(samples.back().time_s, total_s, 1e-9);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double step_s = samples[i].time_s - samples[i - 1].time_s;
    EXPECT_LE(samples[i].velocity_mps.norm(), 5.05);
    EXPECT_LE((samples[i].velocity_mps - samples[i - 1].velocity_mps).norm() / step_s, 6.6);
    EXPECT_EQ(samples[i].timestep, 1u);
  }
}

TEST(FlightTest, TurnsFlyWithTheMoveAndOnlyTheExcessHovers) {
  const double right_angle = std::numbers::pi / 2;
  const FlownMove with_move = FlyOnce(FlownTimes(), Move(20, 0, 0, right_angle));
  EXPECT_NEAR(with_move.end.yaw_rad, right_angle, 0.02);
  EXPECT_EQ(with_move.hovering_s, 0.0);
  EXPECT_LT(with_move.horizontal_s, NominalLegS(20) + 0.34);

  const FlownMove alone = FlyOnce(FlownTimes(), Move(0, 0, 0, -right_angle));
  EXPECT_NEAR(alone.end.yaw_rad, -right_angle, 0.02);
  EXPECT_GT(alone.hovering_s, 1.0);  // 90 degrees at 90 degrees/s ...
  EXPECT_LT(alone.hovering_s, 2.2);  // ... with the time that the rotors need to start and stop the turn
  EXPECT_NEAR((alone.end.position_m - Eigen::Vector3d(265, 265, 60)).norm(), 0.0, 0.02);

  const FlownMove both = FlyOnce(FlownTimes(), Move(1, 0, 0, right_angle));
  EXPECT_NEAR(both.horizontal_s + both.hovering_s, alone.hovering_s, 0.6);
  EXPECT_GT(both.hovering_s, 0.5);
}

TEST(FlightTest, YawStaysInItsRangeOverManyTurns) {
  Flight flight(OpenSky(), FlownTimes(), PoseAt(265, 265, 60, 3.0), 1, 0);
  for (int i = 1; i <= 4; ++i) flight.Execute(Move(2, 0, 0, 1.5), i);
  EXPECT_NEAR(flight.CurrentPose().yaw_rad, std::remainder(3.0 + 4 * 1.5, 2 * std::numbers::pi), 0.1);
  EXPECT_EQ(flight.CurrentPose().tilt_rad, 0.5);
}

TEST(FlightTest, NominalTimesAreDistanceOverSpeed) {
  Config config = FlownTimes();
  config.energy.move_time = MoveTime::kNominal;
  const FlownMove move = FlyOnce(config, Move(12, 9, 10, 0.5));
  EXPECT_NEAR(move.horizontal_s, 3.0, 0.02);
  EXPECT_NEAR(move.ascent_s, 2.0, 0.02);
  EXPECT_EQ(move.hovering_s, 0.0);
  const FlownMove turn = FlyOnce(config, Move(0, 0, 0, std::numbers::pi / 2));
  EXPECT_NEAR(turn.hovering_s, 1.0, 1e-9);
}

TEST(FlightTest, WindIsFlownAgainst) {
  for (const double heading : {0.0, 1.0, 2.5, 4.0, 5.5}) {
    Config config;
    config.environment.wind_x_mps = 8 * std::cos(heading);
    config.environment.wind_y_mps = 8 * std::sin(heading);
    for (const MotionCommand& command :
         {Move(20, 0, 0), Move(0, -12, 15), Move(-3, 4, -15), Move(0, 0, 20)}) {
      const FlownMove move = FlyOnce(config, command);
      EXPECT_NEAR((move.end.position_m - Eigen::Vector3d(265, 265, 60) - command.displacement_m).norm(), 0.0,
                  0.07);
      const double ideal_s = NominalLegS(command.displacement_m.head<2>().norm()) +
                             NominalLegS(std::abs(command.displacement_m.z()));
      EXPECT_LT(move.horizontal_s + move.ascent_s + move.descent_s, ideal_s + 1.2);
      EXPECT_EQ(move.contact_steps, 0);
    }
  }
}

TEST(FlightTest, GustsMoveTheRobotButEveryLegEnds) {
  Config config = FlownTimes();
  config.environment.wind_x_mps = 6;
  config.environment.gust_mps = 3;
  Flight flight(OpenSky(), config, PoseAt(265, 265, 80), 1, 0);
  Stream draw(6, 0, Purpose::kMotion);
  double largest_error_m = 0.0;
  for (int i = 1; i <= 60; ++i) {
    const Eigen::Vector3d before = flight.CurrentPose().position_m;
    const double back = before.x() > 265 ? -1.0 : 1.0;
    const MotionCommand command = Move(back * draw.Uniform(0, 20), draw.Uniform(-5, 5), draw.Uniform(-3, 3));
    const FlownMove move = flight.Execute(command, i);
    largest_error_m =
        std::max(largest_error_m, (move.end.position_m - before - command.displacement_m).norm());
    EXPECT_LT(move.horizontal_s, NominalLegS(command.displacement_m.head<2>().norm()) + 0.34 + kSettleLimitS);
    EXPECT_EQ(move.contact_steps, 0);
  }
  EXPECT_GT(largest_error_m, 0.03);  // the gusts are there
  EXPECT_LT(largest_error_m, 0.6);
}

TEST(FlightTest, StaysInsideTheBox) {
  const Eigen::Vector3d size_m = OpenSky().SizeM();
  for (const Eigen::Vector3d& start : {Eigen::Vector3d(3, 5, 160), Eigen::Vector3d(527, 520, 163)}) {
    Flight flight(OpenSky(), FlownTimes(), PoseAt(start.x(), start.y(), start.z()), 1, 0);
    Recorder recorder;
    flight.SetTrace(&recorder);
    Stream draw(7, 0, Purpose::kMotion);
    for (int i = 1; i <= 25; ++i)
      flight.Execute(Move(draw.Uniform(-20, 20), draw.Uniform(-20, 20), draw.Uniform(-5, 20)), i);
    for (const TraceSample& sample : recorder.samples) {
      EXPECT_TRUE((sample.position_m.array() > 0.2).all()) << sample.position_m.transpose();
      EXPECT_TRUE((sample.position_m.array() < size_m.array() - 0.2).all()) << sample.position_m.transpose();
    }
  }
}

struct OtherAirframe {
  std::string name;
  double mass_kg, width_m, height_m, radius_m;
};

class AirframeFlightTest : public testing::TestWithParam<OtherAirframe> {};

TEST_P(AirframeFlightTest, FliesItsLegs) {
  Config config = FlownTimes();
  config.robot.mass_kg = GetParam().mass_kg;
  config.robot.width_m = config.robot.depth_m = GetParam().width_m;
  config.robot.height_m = GetParam().height_m;
  config.robot.propeller_radius_m = GetParam().radius_m;
  for (const MotionCommand& command :
       {Move(20, 0, 0), Move(-7, 7, -10), Move(0, 1, 10), Move(3, 0, 0, 1.0)}) {
    const FlownMove move = FlyOnce(config, command);
    EXPECT_NEAR((move.end.position_m - Eigen::Vector3d(265, 265, 60) - command.displacement_m).norm(), 0.0,
                0.08);
    const double ideal_s = NominalLegS(command.displacement_m.head<2>().norm()) +
                           NominalLegS(std::abs(command.displacement_m.z()));
    EXPECT_LT(move.horizontal_s + move.ascent_s + move.descent_s, ideal_s + 1.8);
    EXPECT_NEAR(move.end.yaw_rad, command.turn_rad, 0.02);
    EXPECT_EQ(move.contact_steps, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, AirframeFlightTest,
                         testing::Values(OtherAirframe{"palm", 0.25, 0.18, 0.06, 0.06},
                                         OtherAirframe{"small", 0.5, 0.47, 0.23, 0.1},
                                         OtherAirframe{"m100", 3.68, 0.65, 0.3, 0.17},
                                         OtherAirframe{"heavy", 15.0, 1.2, 0.6, 0.38},
                                         OtherAirframe{"giant", 50.0, 3.0, 1.0, 0.8}),
                         [](const auto& info) { return info.param.name; });

TEST(FlightTest, RefusesWhatCannotFly) {
  Config config = FlownTimes();
  config.robot.mass_kg = 0.05;
  config.environment.wind_y_mps = 12;
  EXPECT_THROW(FlyOnce(config, Move(1, 0, 0)), UserError);
}

TEST(FlightTest, CommandsThatAreNotFiniteAreDefects) {
  EXPECT_THROW(FlyOnce(FlownTimes(), Move(std::nan(""), 0, 0)), InternalError);
}

}  // namespace
}  // namespace ed3r::robot
