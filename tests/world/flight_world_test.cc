#include "engine/world/flight_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

#include "tests/world/scene_builder.h"

namespace ed3r::world {
namespace {

constexpr double kGravity = 9.8;
constexpr double kStepS = 1.0 / 240.0;

const RigidBodySpec kRobot = {.mass_kg = 1.8, .size_m = {0.4, 0.6, 0.2}, .inertia_kgm2 = {0.06, 0.03, 0.08}};

Scene FlatScene(std::vector<Tree> trees = {}) {
  return Scene(PartsOf(
      21, 10.0, [](double, double) { return 5.0; }, std::move(trees)));
}

RigidBodyState At(double x, double y, double z) {
  RigidBodyState state;
  state.position_m = {x, y, z};
  return state;
}

TEST(FlightWorldTest, FallsFreelyAndHoversUnderItsWeight) {
  const Scene scene = FlatScene();
  FlightWorld world(scene.Geometry(), kRobot, kGravity, kStepS);
  world.SetState(At(100, 100, 90));
  const int n = 240;
  for (int i = 0; i < n; ++i) world.Step(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  // Semi-implicit Euler: v_n = -g n h, z_n = z_0 - g h^2 n (n + 1) / 2.
  const double h = kStepS;
  EXPECT_NEAR(world.State().velocity_mps.z(), -kGravity * n * h, 1e-4);
  EXPECT_NEAR(world.State().position_m.z(), 90 - kGravity * h * h * n * (n + 1) / 2, 2e-3);

  world.SetState(At(100, 100, 90));
  for (int i = 0; i < n; ++i) world.Step({0.0, 0.0, kRobot.mass_kg * kGravity}, Eigen::Vector3d::Zero());
  EXPECT_NEAR((world.State().position_m - Eigen::Vector3d(100, 100, 90)).norm(), 0.0, 1e-3);
  EXPECT_EQ(world.ContactSteps(), 0);
}

TEST(FlightWorldTest, TorqueActsInBodyAxes) {
  const Scene scene = FlatScene();
  FlightWorld world(scene.Geometry(), kRobot, kGravity, kStepS);
  RigidBodyState state = At(100, 100, 90);
  state.attitude = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  world.SetState(state);
  const Eigen::Vector3d torque_nm(0.0, 0.01, 0.0);
  for (int i = 0; i < 120; ++i) world.Step({0.0, 0.0, kRobot.mass_kg * kGravity}, torque_nm);
  const Eigen::Vector3d expected(0.0, 0.01 / kRobot.inertia_kgm2.y() * 0.5, 0.0);
  EXPECT_NEAR((world.State().rate_radps - expected).norm(), 0.0, 1e-3);
}

TEST(FlightWorldTest, LandsOnTheGroundAndCountsTheContact) {
  const Scene scene = FlatScene();
  FlightWorld world(scene.Geometry(), kRobot, kGravity, kStepS);
  world.SetState(At(100, 100, 5.0 + 0.1 + 0.3));
  int steps_in_air = 0;
  for (int i = 0; i < 480; ++i) {
    world.Step(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    if (world.ContactSteps() == 0) ++steps_in_air;
  }
  // 0.3 m of fall take 59 steps; Bullet thickens the mesh by 4 cm (4 steps less).
  EXPECT_NEAR(steps_in_air, 59, 6);
  EXPECT_GT(world.ContactSteps(), 300);
  EXPECT_NEAR(world.State().position_m.z(), 5.1, 0.06);
  EXPECT_NEAR(world.State().velocity_mps.norm(), 0.0, 0.05);
}

TEST(FlightWorldTest, TouchesTheTrunkThatItPushesInto) {
  const Scene scene = FlatScene({{.x_m = 103,
                                  .y_m = 100,
                                  .ground_m = 5,
                                  .height_m = 20,
                                  .trunk_radius_m = 0.3,
                                  .crown_radius_m = 2,
                                  .crown_depth_m = 8}});
  FlightWorld world(scene.Geometry(), kRobot, kGravity, kStepS);
  world.SetState(At(100, 100, 8));
  for (int i = 0; i < 960; ++i) world.Step({2.0, 0.0, kRobot.mass_kg * kGravity}, Eigen::Vector3d::Zero());
  EXPECT_GT(world.ContactSteps(), 0);
  EXPECT_LT(world.State().position_m.x(), 103.0);
}

// A tumbling robot, once where Bullet must look for contacts at every step, once in clear air.
TEST(FlightWorldTest, NearSurfacesAndInClearAirMotionHasTheSameBits) {
  const Scene clear = FlatScene();
  // Bare poles around the way, which stay a third of a metre off the robot but too near to count as clear.
  std::vector<Tree> poles;
  for (const double y_m : {99.1, 100.9})
    for (double x_m = 90.0; x_m < 130.0; x_m += 0.8)
      poles.push_back({.x_m = x_m,
                       .y_m = y_m,
                       .ground_m = 5,
                       .height_m = 60,
                       .trunk_radius_m = 0.1,
                       .crown_radius_m = 0.15,
                       .crown_depth_m = 1});
  const Scene crowded = FlatScene(std::move(poles));
  const auto fly = [](const Scene& scene) {
    FlightWorld world(scene.Geometry(), kRobot, kGravity, kStepS);
    RigidBodyState state = At(95, 100, 40);
    state.velocity_mps = {4.0, 0.0, 1.0};
    state.rate_radps = {1.5, -2.0, 0.5};
    world.SetState(state);
    std::vector<RigidBodyState> states;
    for (int i = 0; i < 1200; ++i) {
      world.Step({0.3, 0.0, kRobot.mass_kg * kGravity}, {0.001, 0.0, 0.0005});
      states.push_back(world.State());
    }
    EXPECT_EQ(world.ContactSteps(), 0);
    return states;
  };
  ASSERT_TRUE(clear.Geometry().Clear({100, 100, 40}, 2.0));
  for (double x_m = 95; x_m < 115;
       x_m += 0.1)  // within the hull, the reach of contacts and the shorter of the two ways
    ASSERT_FALSE(crowded.Geometry().Clear({x_m, 100, 40}, 0.82)) << x_m;
  const std::vector<RigidBodyState> freely = fly(clear), watched = fly(crowded);
  for (std::size_t i = 0; i < freely.size(); ++i) {
    ASSERT_EQ(freely[i].position_m, watched[i].position_m) << "step " << i;
    ASSERT_EQ(freely[i].attitude.coeffs(), watched[i].attitude.coeffs()) << "step " << i;
    ASSERT_EQ(freely[i].velocity_mps, watched[i].velocity_mps) << "step " << i;
    ASSERT_EQ(freely[i].rate_radps, watched[i].rate_radps) << "step " << i;
  }
}

// However it comes out of clear air: a large tilted airframe, from any height between two questions about the air, slowly and
// as fast as the parameters allow. Seen too late, it would be inside the ground before Bullet looks.
TEST(FlightWorldTest, ClearAirHidesNoContact) {
  const RigidBodySpec large = {.mass_kg = 8.0, .size_m = {2.0, 3.0, 0.5}, .inertia_kgm2 = {6.0, 3.0, 9.0}};
  const Scene scene = FlatScene();
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 0.5, 0).normalized()));
  const auto lowest_corner_m = [&](const RigidBodyState& state) {
    double lowest_m = state.position_m.z();
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d end(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.5 : -1.5, corner & 4 ? 0.25 : -0.25);
      lowest_m = std::min(lowest_m, (state.position_m + state.attitude * end).z());
    }
    return lowest_m;
  };
  for (const double speed_mps : {1.0, 5.0, 15.0}) {
    for (int start = 0; start < 10; ++start) {
      FlightWorld world(scene.Geometry(), large, kGravity, kStepS);
      RigidBodyState state = At(100, 100, 20.0 + 0.1 * start);
      state.attitude = tilted;
      state.velocity_mps = {0.3 * speed_mps, 0.0, -speed_mps};
      world.SetState(state);
      for (int i = 0; i < 240 * 20 && world.ContactSteps() == 0; ++i)
        world.Step({0.0, 0.0, large.mass_kg * kGravity}, Eigen::Vector3d::Zero());
      EXPECT_GT(world.ContactSteps(), 0) << speed_mps << " " << start;
      // Bullet thickens ground and robot by 4.5 cm. It looks where the last step ended, up to a step's way too deep,
      // and has moved the robot by another step before it can be asked.
      const double gap_m = lowest_corner_m(world.State()) - 5.0;
      EXPECT_GT(gap_m, -2.0 * speed_mps * kStepS) << speed_mps << " " << start;
      EXPECT_LT(gap_m, 0.08 + speed_mps * kStepS) << speed_mps << " " << start;
    }
  }
}

// Off the ground, up through clear air and down again: what Bullet remembers of a contact does not outlive it, and every
// landing is found.
TEST(FlightWorldTest, EveryLandingAfterClearAirIsAContact) {
  const Scene scene = FlatScene();
  FlightWorld world(scene.Geometry(), kRobot, kGravity, kStepS);
  world.SetState(At(100, 100, 12));
  constexpr int kCycle = 960;  // falls and lies for three seconds, is lifted for one
  for (int cycle = 0; cycle < 4; ++cycle) {
    const int before = world.ContactSteps();
    double highest_m = 0.0, lowest_m = 1e9;
    for (int i = 0; i < kCycle; ++i) {
      const double lift_n = i < 720 ? 0.0 : 1.8 * kRobot.mass_kg * kGravity;
      world.Step({0.0, 0.0, lift_n}, Eigen::Vector3d::Zero());
      highest_m = std::max(highest_m, world.State().position_m.z());
      lowest_m = std::min(lowest_m, world.State().position_m.z());
    }
    EXPECT_GT(world.ContactSteps(), before) << "cycle " << cycle;
    EXPECT_GT(highest_m, 9.0) << "cycle " << cycle << ": must have left for clear air";
    EXPECT_GT(lowest_m, 5.0) << "cycle " << cycle << ": the hull's middle never sinks into the ground";
  }
}

TEST(FlightWorldTest, WorldsInOtherThreadsChangeNothing) {
  const Scene scene = FlatScene();
  const auto bounce = [&](double x_m) {
    FlightWorld world(scene.Geometry(), kRobot, kGravity, kStepS);
    RigidBodyState state = At(x_m, 50, 6);
    state.velocity_mps = {3.0, 1.0, -2.0};
    state.rate_radps = {1.0, -2.0, 0.5};
    world.SetState(state);
    for (int i = 0; i < 2000; ++i) world.Step({0.1, 0.0, 0.0}, {0.0, 0.0, 0.001});
    return world.State();
  };
  const RigidBodyState alone = bounce(60.0);
  std::vector<RigidBodyState> together(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < together.size(); ++i)
    threads.emplace_back([&, i] { together[i] = bounce(60.0); });
  for (std::thread& thread : threads) thread.join();
  for (const RigidBodyState& state : together) {
    EXPECT_EQ(state.position_m, alone.position_m);
    EXPECT_EQ(state.attitude.coeffs(), alone.attitude.coeffs());
    EXPECT_EQ(state.velocity_mps, alone.velocity_mps);
  }
}

}  // namespace
}  // namespace ed3r::world
