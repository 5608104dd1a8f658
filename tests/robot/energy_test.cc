// The energy model against numbers worked out by hand, with every factor far from 1.
#include "engine/robot/energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/robot/ledger.h"
#include "engine/robot/power/power_models.h"

namespace ed3r::robot {
namespace {

RobotConfig Heavy() {
  RobotConfig robot;
  robot.mass_kg = 3.0;
  robot.propeller_radius_m = 0.2;
  robot.propellers = 6;
  robot.height_m = 0.3, robot.width_m = 0.5, robot.depth_m = 0.7;
  robot.speed_mps = 4.0;
  robot.drag_horizontal = 0.6, robot.drag_vertical = 0.4;
  return robot;
}

EnvironmentConfig Thin() {
  EnvironmentConfig environment;
  environment.air_density_kgm3 = 0.8;
  environment.gravity_mps2 = 9.0;
  return environment;
}

constexpr double kDiscM2 = 6 * std::numbers::pi * 0.04;

TEST(EnergyTest, HoverIsTheIdealPowerOfTheWeight) {
  const double weight_n = 27.0;
  const double expected_w = weight_n * std::sqrt(weight_n / (2 * 0.8 * kDiscM2));
  EXPECT_NEAR(MovementPowerOf(Heavy(), Thin(), {}).hover_w, expected_w, 1e-9 * expected_w);
  EXPECT_NEAR(IdealHoverPowerW(3.0, 0.8, 9.0, kDiscM2), expected_w, 1e-9 * expected_w);
  EnergyConfig printed;  // as the paper prints it, with the density above the line
  printed.hover_form = HoverForm::kPrinted;
  const double printed_w = std::pow(3.0, 1.5) * std::sqrt(729.0 / 12 * 0.8 * std::numbers::pi * 0.04);
  EXPECT_NEAR(MovementPowerOf(Heavy(), Thin(), printed).hover_w, printed_w, 1e-9 * printed_w);
}

TEST(EnergyTest, HorizontalFlightPaysDragOnTopOfHover) {
  const MovementPower power = MovementPowerOf(Heavy(), Thin(), {});
  const double drag_w = 0.5 * 0.8 * 0.6 * (0.3 * 0.5) * 64;
  EXPECT_NEAR(power.horizontal_w - power.hover_w, drag_w, 1e-9 * drag_w);
}

TEST(EnergyTest, VerticalFlightInEachForm) {
  const double drag = 0.5 * 0.8 * 0.4 * (0.5 * 0.7) * 64;
  EnergyConfig energy;
  energy.vertical_form = VerticalForm::kPrinted;
  const MovementPower printed = MovementPowerOf(Heavy(), Thin(), energy);
  EXPECT_NEAR(printed.ascent_w, 27 + drag, 1e-9);
  EXPECT_NEAR(printed.descent_w, 27 - drag, 1e-9);
  energy.vertical_form = VerticalForm::kMgv;
  const MovementPower per_speed = MovementPowerOf(Heavy(), Thin(), energy);
  EXPECT_NEAR(per_speed.ascent_w, 27 * 4 + drag, 1e-9);
  EXPECT_NEAR(per_speed.descent_w, 27 * 4 - drag, 1e-9);
  energy.vertical_form = VerticalForm::kClimb;
  const MovementPower climb = MovementPowerOf(Heavy(), Thin(), energy);
  EXPECT_NEAR(climb.ascent_w - climb.hover_w, 27 * 4.0, 1e-9);
  EXPECT_NEAR(climb.hover_w - climb.descent_w, 27 * 4.0, 1e-9);
  RobotConfig fast = Heavy();
  fast.speed_mps = 8.0;
  EXPECT_EQ(MovementPowerOf(fast, Thin(), energy).descent_w, 0.0) << "a descent does not charge the battery";
  fast.speed_mps = (climb.hover_w - 5e-4) / 27;
  EXPECT_NEAR(MovementPowerOf(fast, Thin(), energy).descent_w, 5e-4, 1e-9) << "but may take half a milliwatt";
}

// As printed it draws m g - rho/2 A C v^3: 1.816 * 9.8 - 0.0473558 v^3 W, nothing from 7.2167 m/s on.
TEST(EnergyTest, ADescentThatWouldChargeTheBatteryIsRefused) {
  Config config;
  config.robot.speed_mps = 7.21;
  EXPECT_EQ(CheckBilledPower(config), "");
  config.robot.speed_mps = 8;
  EXPECT_EQ(CheckBilledPower(config),
            "robot.speed_mps: '8' is not allowed; a descent would charge the battery (-6.4 W with "
            "energy.vertical_form = "
            "printed): at most 7.21 m/s, or energy.vertical_form climb, or energy.model momentum");
  config.energy.vertical_form = VerticalForm::kClimb;
  EXPECT_EQ(CheckBilledPower(config), "");
  config = Config();
  config.robot.speed_mps = 15;
  config.energy.model = PowerModel::kMomentum;
  EXPECT_EQ(CheckBilledPower(config), "");
}

TEST(EnergyTest, EfficiencyDividesWhatThePaperCallsMechanical) {
  EnergyConfig energy;
  const MovementPower ideal = MovementPowerOf(Heavy(), Thin(), energy);
  energy.paper_efficiency = 0.5;
  const MovementPower real = MovementPowerOf(Heavy(), Thin(), energy);
  EXPECT_NEAR(real.hover_w, 2 * ideal.hover_w, 1e-9);
  EXPECT_NEAR(real.horizontal_w, 2 * ideal.horizontal_w, 1e-9);
  EXPECT_NEAR(real.ascent_w, 2 * ideal.ascent_w, 1e-9);
  EXPECT_NEAR(real.descent_w, 2 * ideal.descent_w, 1e-9);
}

// Momentum theory: hover in closed form; a climb at speed V against v_i (V + v_i) = T / (2 rho A), with no drag.
TEST(EnergyTest, MomentumTheoryInHoverAndClimb) {
  EnergyConfig energy;
  energy.model = PowerModel::kMomentum;
  energy.momentum_efficiency = 0.8, energy.induced_factor = 1.25, energy.profile_share = 0.3;
  energy.interference = 0.0, energy.drag_area_m2 = 0.0;
  const MovementPower power = MovementPowerOf(Heavy(), Thin(), energy);
  const double squared = 27.0 / (2 * 0.8 * kDiscM2), hover_w = 27 * std::sqrt(squared);
  EXPECT_NEAR(power.hover_w, (1.25 + 0.3) * hover_w / 0.8, 1e-6 * hover_w);
  const auto axial_w = [&](double climb_mps) {
    const double induced_mps = -climb_mps / 2 + std::sqrt(climb_mps * climb_mps / 4 + squared);
    return (1.25 * 27 * induced_mps + 0.3 * hover_w + 27 * climb_mps) / 0.8;
  };
  EXPECT_NEAR(power.ascent_w, axial_w(4.0), 1e-6 * hover_w);
  EXPECT_LT(power.descent_w, power.hover_w);
  EXPECT_LT(power.horizontal_w, power.hover_w) << "translational lift";
}

TEST(EnergyTest, TheFourMovementsAreAtTheirSpeedAndStillOtherwise) {
  EnergyConfig energy;
  energy.model = PowerModel::kMomentum;
  const MovementPower power = MovementPowerOf(Heavy(), Thin(), energy);
  const MomentumParameters<> parameters{energy.momentum_efficiency, energy.induced_factor,
                                        energy.interference, energy.profile_share, energy.drag_area_m2};
  const auto power_w = [&](double horizontal_mps, double climb_mps) {
    return MomentumPowerW(parameters, 3.0, horizontal_mps, climb_mps, Air{0.8, 9.0},
                          MakeRotorcraft(Heavy()).DiscAreaM2());
  };
  EXPECT_EQ(power.hover_w, power_w(0, 0));
  EXPECT_EQ(power.horizontal_w, power_w(4, 0));
  EXPECT_EQ(power.ascent_w, power_w(0, 4));
  EXPECT_EQ(power.descent_w, power_w(0, -4));
}

// Airspeeds in a wind of (3, -4) m/s: 5 held in place, 4 - 3 and 4 away along (1, 0), 4 + 4 and 3 along (0, 1).
TEST(EnergyTest, MomentumTheoryIsBilledAtAirspeeds) {
  EnergyConfig energy;
  energy.model = PowerModel::kMomentum;
  EnvironmentConfig windy = Thin();
  windy.wind_x_mps = 3.0, windy.wind_y_mps = -4.0;
  const MomentumParameters<> parameters{energy.momentum_efficiency, energy.induced_factor,
                                        energy.interference, energy.profile_share, energy.drag_area_m2};
  const auto power_w = [&](double horizontal_mps, double climb_mps) {
    return MomentumPowerW(parameters, 3.0, horizontal_mps, climb_mps, Air{0.8, 9.0}, kDiscM2);
  };
  const MovementPower power = MovementPowerOf(Heavy(), windy, energy);
  EXPECT_NEAR(power.hover_w, power_w(5, 0), 1e-9);
  EXPECT_NEAR(power.ascent_w, power_w(5, 4), 1e-9);
  EXPECT_NEAR(power.descent_w, power_w(5, -4), 1e-9);
  EXPECT_NEAR(power.horizontal_w, power_w(std::sqrt(16.0 + 25.0), 0), 1e-9) << "across the wind";
  EXPECT_NEAR(MovementPowerOf(Heavy(), windy, energy, {1, 0}).horizontal_w, power_w(std::sqrt(1.0 + 16.0), 0),
              1e-9);
  EXPECT_NEAR(MovementPowerOf(Heavy(), windy, energy, {0, 1}).horizontal_w, power_w(std::sqrt(64.0 + 9.0), 0),
              1e-9);
  EXPECT_TRUE(BillsWind(windy, energy));
  EnvironmentConfig east = Thin(), south = Thin();
  east.wind_x_mps = 3.0, south.wind_y_mps = -4.0;
  EXPECT_TRUE(BillsWind(east, energy) && BillsWind(south, energy));
  EXPECT_FALSE(BillsWind(Thin(), energy));
  energy.model = PowerModel::kPaper;  // of still air
  EXPECT_FALSE(BillsWind(windy, energy));
  EXPECT_EQ(MovementPowerOf(Heavy(), windy, energy, {1, 0}).horizontal_w,
            MovementPowerOf(Heavy(), Thin(), energy).horizontal_w);
}

// The shares at several airspeeds: v_i of Glauert's equation found by bisection outside this program, the rest by hand from
// P = [kappa (1 + chi (1 - cos X)) T v_i + c_p T^1.5 / sqrt(2 rho A) + D V + m g v_v] / efficiency.
TEST(EnergyTest, MomentumTheoryInFlight) {
  const MomentumParameters<> parameters{0.8, 1.25, 0.6, 0.3, 0.2};
  const Air air{0.8, 9.0};
  struct Flight {
    double horizontal_mps, climb_mps, induced_w, profile_w, parasite_w, climb_w;
  };
  for (const Flight& by_hand :
       {Flight{4, 0, 193.37960134234342, 47.98081155206458, 6.4, 0},
        Flight{4, 2, 162.3655160011831, 49.91637511265461, 8.944271909999161, 67.5},
        Flight{3, -2, 242.87604459237474, 46.410453431644875, 4.6872166581031856, -67.5},
        // faster than its own wake: the flow along the thrust stops at -v_i(hover)
        Flight{0, -12, 140.19210354184148, 20.794436386368613, 172.8, -242.11478795456208}}) {
    const MomentumPower<> power =
        MomentumPowersW(parameters, 3.0, by_hand.horizontal_mps, by_hand.climb_mps, air, kDiscM2);
    SCOPED_TRACE(by_hand.climb_mps);
    EXPECT_NEAR(power.induced_w, by_hand.induced_w, 1e-9);
    EXPECT_NEAR(power.profile_w, by_hand.profile_w, 1e-9);
    EXPECT_NEAR(power.parasite_w, by_hand.parasite_w, 1e-9);
    EXPECT_NEAR(power.climb_w, by_hand.climb_w, 1e-9);
    EXPECT_NEAR(power.TotalW(), by_hand.induced_w + by_hand.profile_w + by_hand.parasite_w + by_hand.climb_w,
                1e-9);
  }
}

// Induced power (1 + sqrt 5) / 2 x 0.5 of what the descent gives back: the rest would charge the battery.
TEST(EnergyTest, AFastDescentWithCheapRotorsTakesNothing) {
  const MomentumPower<> power =
      MomentumPowersW(MomentumParameters<>{0.8, 0.5, 0.0, 0.0, 0.0}, 3.0, 0.0, -12.0, {0.8, 9.0}, kDiscM2);
  EXPECT_NEAR(power.induced_w, 0.5 * 0.5 * (1 + std::sqrt(5.0)) * 27 * std::sqrt(27 / (1.6 * kDiscM2)) / 0.8,
              1e-9);
  EXPECT_EQ(power.climb_w, -power.induced_w);
  EXPECT_EQ(power.TotalW(), 0.0);
  const MomentumPower<> dragging =
      MomentumPowersW(MomentumParameters<>{0.8, 0.5, 0.0, 0.1, 0.0}, 3.0, 0.0, -12.0, {0.8, 9.0}, kDiscM2);
  EXPECT_GT(dragging.profile_w, 1.0);
  EXPECT_EQ(dragging.climb_w, -(dragging.induced_w + dragging.profile_w));
}

TEST(EnergyTest, ATimestepOfNothingCostsNothing) {
  EXPECT_EQ(StepTime().TotalS(), 0.0);
  EXPECT_EQ(StepEnergy().TotalJ(), 0.0);
  EXPECT_EQ(Charge({1, 1, 1, 1}, {}, {}).TotalJ(), 0.0);
}

TEST(EnergyTest, SensorsAreBilledForThePeriod) {
  SensingConfig sensing;
  sensing.period_s = 2.5, sensing.camera_power_w = 3.0, sensing.lidars = 4, sensing.lidar_power_w = 0.5;
  EXPECT_NEAR(SensingEnergyJ(sensing), 2.5 * (3.0 + 4 * 0.5), 1e-12);
}

TEST(EnergyTest, ComputationOfAllFramesOfAPeriod) {
  SensingConfig sensing;
  sensing.period_s = 2.0, sensing.camera_fps = 10;
  CpuConfig cpu;
  cpu.cores = 3, cpu.flops_per_cycle = 4, cpu.capacitance = 2e-28;
  const ComputationCost cost = Computation(cpu, sensing, 5.0, 2e9);
  EXPECT_NEAR(cost.time_s, 20 * 5e9 / (4 * 3 * 2e9), 1e-12);
  EXPECT_NEAR(cost.energy_j, 2e-28 * 20 * 5e9 * 4e18 / 4, 1e-9);
}

TEST(EnergyTest, APayloadIsEveryFrame) {
  SensingConfig sensing;
  sensing.period_s = 2.0, sensing.camera_fps = 10, sensing.frame_byte = 1000;
  EXPECT_EQ(PayloadByte(sensing), 20000.0);
}

// A unit of time and of power for each entry: no two products are equal, so that none can stand in another's place.
TEST(EnergyTest, EachTimeIsChargedAtItsPower) {
  const MovementPower power{.hover_w = 2, .horizontal_w = 3, .ascent_w = 5, .descent_w = 7};
  const StepTime time{.horizontal_s = 11,
                      .ascent_s = 13,
                      .descent_s = 17,
                      .turning_s = 19,
                      .sensing_s = 23,
                      .computing_s = 29,
                      .transmitting_s = 31};
  const StepEnergy energy = Charge(power, time, {.sensing_j = 37, .computation_j = 41, .transmission_j = 43});
  EXPECT_EQ(energy.horizontal_j, 33);
  EXPECT_EQ(energy.ascent_j, 65);
  EXPECT_EQ(energy.descent_j, 119);
  EXPECT_EQ(energy.hover_turning_j, 38);
  EXPECT_EQ(energy.hover_sensing_j, 46);
  EXPECT_EQ(energy.hover_computing_j, 58);
  EXPECT_EQ(energy.hover_transmitting_j, 62);
  EXPECT_EQ(energy.sensing_j, 37);
  EXPECT_EQ(energy.computation_j, 41);
  EXPECT_EQ(energy.transmission_j, 43);
  EXPECT_EQ(energy.MovementJ(), 421);
  EXPECT_EQ(energy.TotalJ(), 542);
  EXPECT_EQ(time.TotalS(), 143);
}

}  // namespace
}  // namespace ed3r::robot
