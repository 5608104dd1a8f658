// The 2 m safety rule (R24): halts, freedom of contact, and that contacts are counted without it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include "engine/core/random.h"
#include "engine/robot/airframe.h"
#include "engine/robot/flight.h"
#include "tests/world/scene_builder.h"

namespace ed3r::robot {
namespace {

constexpr double kPi = std::numbers::pi;
// Flat ground and, in the east, a cliff 60 m high and half a metre thick, which is at kWallX 30 m above
// ground.
constexpr double kWallX = 119.75;

const world::Scene& Cliff() {
  static const world::Scene scene(
      world::PartsOf(401, 0.5, [](double x, double) { return x < 119.75 ? 0.0 : 60.0; }));
  return scene;
}

world::Tree MakeTree(double x_m, double y_m, double trunk_radius_m, double height_m = 16.0) {
  return {.x_m = x_m,
          .y_m = y_m,
          .ground_m = 0.0,
          .height_m = height_m,
          .trunk_radius_m = trunk_radius_m,
          .crown_radius_m = 2.0,
          .crown_depth_m = 0.5 * height_m};
}

MotionCommand Move(double dx_m, double dy_m, double dz_m, double turn_rad = 0.0) {
  return {.displacement_m = {dx_m, dy_m, dz_m}, .turn_rad = turn_rad};
}

constexpr double kTubeM = 0.56;  // half width of what the LiDARs probe

// Half the diagonal of the body: its centre rests this much further away than its hull.
double HullM() { return 0.5 * std::hypot(Config().robot.width_m, Config().robot.depth_m); }

TEST(ObstacleTest, HaltsTwoMetresFromAWallAtAnyAngle) {
  Stream draw(1, 0, Purpose::kMotion);
  for (int i = 0; i < 40; ++i) {
    Config config;
    if (i % 2 == 1) config.energy.move_order = MoveOrder::kVerticalFirst;
    const double angle = draw.Uniform(-80.0, 80.0) * kPi / 180.0;
    const Eigen::Vector3d direction(std::cos(angle), std::sin(angle), 0.0);
    const double ahead_m = draw.Uniform(4.0, 15.0);  // from the start to the wall along the way
    const Eigen::Vector3d start = Eigen::Vector3d(kWallX, 100, 30) - ahead_m * direction;
    Flight flight(Cliff(), config, {.position_m = start}, 1, 0);
    const Eigen::Vector3d way = 20.0 * direction;
    const FlownMove move = flight.Execute(Move(way.x(), way.y(), draw.Uniform(1, 5)), 1);
    SCOPED_TRACE(angle);
    EXPECT_TRUE(move.halted);
    EXPECT_EQ(move.contact_steps, 0);
    const Eigen::Vector3d end = move.end.position_m;
    const double left_m = Cliff().Geometry().Distance(end, direction, 30.0) - HullM();
    EXPECT_GE(left_m, 1.95);
    EXPECT_LE(left_m, 2.3 + kTubeM * std::tan(std::abs(angle)));  // the tube's edge meets the wall first
    if (std::abs(angle) < 0.8) {
      EXPECT_GE(kWallX - end.x(), 1.9);
    }
    EXPECT_NE(move.ascent_s + move.descent_s, 0.0);  // the other leg is still flown
  }
}

TEST(ObstacleTest, HaltsTwoMetresFromATrunkInEveryDirection) {
  const world::Scene scene(
      world::PartsOf(21, 10.0, [](double, double) { return 0.0; }, {MakeTree(100, 100, 0.15, 30.0)}));
  Stream draw(2, 0, Purpose::kMotion);
  for (int i = 0; i < 60; ++i) {
    const double angle = draw.Uniform(0, 2 * kPi);
    const Eigen::Vector3d direction(std::cos(angle), std::sin(angle), 0.0);
    const Eigen::Vector3d side(-direction.y(), direction.x(), 0.0);
    const Eigen::Vector3d start = Eigen::Vector3d(100, 100, draw.Uniform(4, 11)) -
                                  draw.Uniform(5, 15) * direction + draw.Uniform(-0.4, 0.4) * side;
    Flight flight(scene, Config(), {.position_m = start}, 1, 0);
    const Eigen::Vector3d way = 20.0 * direction;
    const FlownMove move = flight.Execute(Move(way.x(), way.y(), 0), 1);
    EXPECT_TRUE(move.halted);
    EXPECT_EQ(move.contact_steps, 0);
    const double gap_m =
        (move.end.position_m - Eigen::Vector3d(100, 100, move.end.position_m.z())).norm() - 0.15;
    EXPECT_GE(gap_m - HullM(), 1.95);
    EXPECT_LE(gap_m - HullM(), 2.4);
  }
}

TEST(ObstacleTest, HaltsTwoMetresAboveGroundAndBelowACrown) {
  const world::Scene scene(
      world::PartsOf(21, 10.0, [](double, double) { return 0.0; }, {MakeTree(100, 100, 0.2, 30.0)}));
  Flight down(scene, Config(), {.position_m = {60, 60, 15}}, 1, 0);
  const FlownMove landing = down.Execute(Move(0, 0, -20), 1);
  EXPECT_TRUE(landing.halted);
  const double belly_m = landing.end.position_m.z() - 0.5 * Config().robot.height_m;
  EXPECT_GE(belly_m, 1.95);
  EXPECT_LE(belly_m, 2.2);
  EXPECT_EQ(landing.contact_steps, 0);

  Flight up(scene, Config(), {.position_m = {101.2, 100, 6}}, 1, 0);
  const FlownMove climb = up.Execute(Move(0, 0, 20), 1);
  EXPECT_TRUE(climb.halted);
  EXPECT_EQ(climb.contact_steps, 0);
  EXPECT_GE(scene.Geometry().Distance(climb.end.position_m, Eigen::Vector3d::UnitZ(), 30.0), 2.0);
}

TEST(ObstacleTest, DoesNotBeginALegWithoutRoomButFliesAway) {
  const double hull_m = HullM();
  Flight flight(Cliff(), Config(), {.position_m = {kWallX - 2.1 - hull_m, 100, 30}}, 1, 0);
  const FlownMove towards = flight.Execute(Move(10, 0, 0), 1);
  EXPECT_TRUE(towards.halted);
  EXPECT_EQ(towards.horizontal_s, 0.0);
  EXPECT_EQ(towards.distance_m, 0.0);
  EXPECT_EQ(flight.PhysicsSteps(), 0);
  const FlownMove along = flight.Execute(Move(0, 15, 0), 2);
  EXPECT_FALSE(along.halted);
  EXPECT_NEAR(along.end.position_m.y(), 115.0, 0.05);
  const FlownMove away = flight.Execute(Move(-10, 0, 0), 3);
  EXPECT_FALSE(away.halted);
}

TEST(ObstacleTest, ShortSightedLidarsDoNotHaltInFreeAir) {
  Config config;
  config.sensing.lidar_range_m = 8.0;
  config.agents.axis_range_m = 200.0;
  for (const double rate_hz : {10.0, 24.0, 120.0}) {
    config.sensing.lidar_rate_hz = rate_hz;
    config.robot.speed_mps = 15.0;
    const FlightEnvelope envelope = EnvelopeOf(Airframe(config), config);
    config.robot.speed_mps = std::min(envelope.horizontal.speed_mps, envelope.vertical.speed_mps);
    Flight flight(Cliff(), config, {.position_m = {20, 100, 30}}, 1, 0);
    const FlownMove move = flight.Execute(Move(60, 50, 0), 1);
    EXPECT_FALSE(move.halted);
    EXPECT_NEAR((move.end.position_m - Eigen::Vector3d(80, 150, 30)).norm(), 0.0, 0.05);
    EXPECT_GT(flight.LidarScans(), 5);
    const FlownMove to_wall = flight.Execute(Move(60, 0, 0), 2);
    EXPECT_TRUE(to_wall.halted);
    EXPECT_NEAR(kWallX - to_wall.end.position_m.x() - HullM(), 2.1, 0.2);
  }
}

TEST(ObstacleTest, WithoutTheRuleContactsAreCounted) {
  Config config;
  config.agents.obstacle_avoidance = false;
  Flight flight(Cliff(), config, {.position_m = {kWallX - 8, 100, 30}}, 1, 0);
  const FlownMove crash = flight.Execute(Move(15, 0, 0), 1);
  EXPECT_GT(crash.contact_steps, 0);
  EXPECT_FALSE(crash.halted);
  EXPECT_LT(crash.end.position_m.x(), kWallX + 0.5);
  EXPECT_LT(crash.horizontal_s, 15.0);

  Flight ground(Cliff(), config, {.position_m = {50, 100, 10}}, 1, 0);
  EXPECT_GT(ground.Execute(Move(0, 0, -20), 1).contact_steps, 0);
}

world::Scene Forest() {
  std::vector<world::Tree> trees;
  Stream draw(11, 0, Purpose::kWorld);
  const auto height_m = [](double x, double y) {
    return 6.0 + 5.0 * std::sin(0.08 * x) * std::cos(0.06 * y);
  };
  while (trees.size() < 160) {
    world::Tree tree =
        MakeTree(draw.Uniform(5, 155), draw.Uniform(5, 155), draw.Uniform(0.15, 0.35), draw.Uniform(6, 22));
    tree.crown_radius_m = draw.Uniform(1.0, 3.0);
    if (std::hypot(tree.x_m - 80, tree.y_m - 80) < 8) continue;
    tree.ground_m = height_m(tree.x_m, tree.y_m);
    trees.push_back(tree);
  }
  return world::Scene(world::PartsOf(81, 2.0, height_m, trees));
}

struct Walk {
  std::vector<FlownMove> moves;
  int contact_steps = 0;
  int halts = 0;
};

// A random walk of 50 timesteps that comes back down again and again.
Walk FlyWalk(const world::Scene& scene, std::uint32_t scenario, const Config& config = Config()) {
  Flight flight(scene, config, {.position_m = {80, 80, 18}}, 5, scenario);
  Walk walk;
  for (std::uint32_t k = 1; k <= 50; ++k) {
    Stream draw(5, scenario, Purpose::kMotion, k);
    const double reach_m = k % 2 == 0 ? 2.0 : 6.0;
    const MotionCommand command = Move(draw.Uniform(-reach_m, reach_m), draw.Uniform(-reach_m, reach_m),
                                       draw.Uniform(-reach_m, 0.8 * reach_m), draw.Uniform(-1.5, 1.5));
    walk.moves.push_back(flight.Execute(command, k));
    walk.contact_steps += walk.moves.back().contact_steps;
    walk.halts += walk.moves.back().halted;
  }
  return walk;
}

TEST(ObstacleTest, TwoHundredWalksThroughAForestTouchNothing) {
  const world::Scene scene = Forest();
  constexpr int kWalks = 200;
  constexpr int kThreads = 2;
  std::vector<Walk> walks(kWalks);
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      for (int i = t; i < kWalks; i += kThreads) walks[i] = FlyWalk(scene, i);
    });
  for (std::thread& thread : threads) thread.join();
  int halts = 0;
  for (int i = 0; i < kWalks; ++i) {
    EXPECT_EQ(walks[i].contact_steps, 0) << "walk " << i;
    halts += walks[i].halts;
    for (const FlownMove& move : walks[i].moves)
      ASSERT_GT(move.end.position_m.z(),
                scene.Ground().HeightAt(move.end.position_m.x(), move.end.position_m.y()));
  }
  EXPECT_GT(halts, 50 * kWalks / 10);  // the walks do meet obstacles
}

bool SameBits(const FlownMove& a, const FlownMove& b) {
  return a.end.position_m == b.end.position_m && a.end.yaw_rad == b.end.yaw_rad &&
         a.horizontal_s == b.horizontal_s && a.ascent_s == b.ascent_s && a.descent_s == b.descent_s &&
         a.hovering_s == b.hovering_s && a.distance_m == b.distance_m && a.halted == b.halted &&
         a.contact_steps == b.contact_steps;
}

TEST(ObstacleTest, WalksAreTheSameBitForBitAloneAndBesideOthers) {
  const world::Scene scene = Forest();
  Config config;
  config.environment.wind_x_mps = 4.0;
  config.environment.gust_mps = 1.5;
  const Walk alone = FlyWalk(scene, 3, config);
  Walk again;
  Walk other;
  std::thread first([&] { again = FlyWalk(scene, 3, config); });
  std::thread second([&] { other = FlyWalk(scene, 4, config); });
  first.join();
  second.join();
  ASSERT_EQ(alone.moves.size(), again.moves.size());
  for (std::size_t k = 0; k < alone.moves.size(); ++k)
    EXPECT_TRUE(SameBits(alone.moves[k], again.moves[k])) << k;
  EXPECT_FALSE(SameBits(alone.moves.back(), other.moves.back()));
}

}  // namespace
}  // namespace ed3r::robot
