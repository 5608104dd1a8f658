// Each invariant on a record that was flown and then broken in one place: it must notice what it is there for.
#include "engine/mission/invariants.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <optional>

#include "engine/mission/mission.h"
#include "tests/mission/small_world.h"

namespace ed3r::mission {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class InvariantsTest : public ::testing::Test {
 protected:
  InvariantsTest() {
    config_.mission.strategy = "random";
    flown_ = FlyMission({.scene = scene_, .config = config_, .seed = 5, .scenario = 3});
  }

  // Which invariant the flown record breaks after `change`; nothing when it breaks none.
  std::optional<Invariant> Broken(const std::function<void(MissionRecord&)>& change,
                                  double gust_mps = 0) const {
    MissionRecord record = flown_;
    change(record);
    try {
      CheckInvariants(record, {power_, config_.robot.BatteryJ(), scene_, gust_mps});
    } catch (const BrokenInvariant& error) {
      EXPECT_EQ(std::string(error.what()).find(NameOf(error.Which())), 0u) << error.what();
      return error.Which();
    }
    return std::nullopt;
  }

  world::Scene scene_{FlatParts()};
  Config config_;
  const robot::MovementPower power_ =
      robot::MovementPowerOf(config_.robot, config_.environment, config_.energy);
  MissionRecord flown_;
};

TEST_F(InvariantsTest, AFlownMissionBreaksNone) {
  ASSERT_GT(flown_.steps.size(), 20u);
  EXPECT_EQ(Broken([](MissionRecord&) {}), std::nullopt);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].rc_predicted_reward = kNaN; }), std::nullopt);
}

TEST_F(InvariantsTest, ANumberThatIsNone) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].reward = kNaN; }), Invariant::kValuesFinite);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].rc_predicted_reward = kInfinity; }),
            Invariant::kValuesFinite);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.reliable_scs_sum = kNaN; }), Invariant::kValuesFinite);
}

TEST_F(InvariantsTest, TimeThatDoesNotGoForward) {
  EXPECT_EQ(Broken([](MissionRecord& r) { std::swap(r.steps[3], r.steps[4]); }), Invariant::kTimeMonotone);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps.erase(r.steps.begin() + 3); }), Invariant::kTimeMonotone);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps.pop_back(); }), Invariant::kTimeMonotone);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].turning_s = -1e-12; }), Invariant::kTimeMonotone);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.duration_s += 1e-3; }), Invariant::kTimeMonotone);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.timesteps += 1; }), Invariant::kTimeMonotone);
}

TEST_F(InvariantsTest, ALedgerThatDoesNotAddUp) {
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].total_j += 1e-3; }), Invariant::kLedgerAddsUp);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].sensing_j += 1e-3; }), Invariant::kLedgerAddsUp);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].hover_sensing_j = -1; }), Invariant::kLedgerAddsUp);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].battery_j += 1e-3; }), Invariant::kLedgerAddsUp);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.movement_j += 1; }), Invariant::kLedgerAddsUp);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.battery_left_j += 1; }), Invariant::kLedgerAddsUp);
}

// A ledger that adds up and still spends what was not there.
TEST_F(InvariantsTest, ABatteryBelowZero) {
  MissionRecord record = flown_;
  const double debt_j = record.battery_left_j + 1;
  for (TimestepRecord& step : record.steps) step.battery_j -= debt_j;
  record.battery_left_j -= debt_j;
  EXPECT_NO_THROW(CheckLedger(record, power_, config_.robot.BatteryJ() - debt_j));
  try {
    CheckInvariants(record, {power_, config_.robot.BatteryJ() - debt_j, scene_});
    ADD_FAILURE() << "not noticed";
  } catch (const BrokenInvariant& error) {
    EXPECT_EQ(error.Which(), Invariant::kBatteryNotNegative);
  }
}

TEST_F(InvariantsTest, ARobotOutOfTheWorld) {
  for (const double x_m : {-0.2, 400.2})
    EXPECT_EQ(Broken([&](MissionRecord& r) { r.steps[3].x_m = x_m; }), Invariant::kPositionInWorld) << x_m;
  for (const double y_m : {-0.2, 400.2})
    EXPECT_EQ(Broken([&](MissionRecord& r) { r.steps[3].y_m = y_m; }), Invariant::kPositionInWorld) << y_m;
  for (const double z_m : {-0.2, 165.2})  // in the ground, above the box
    EXPECT_EQ(Broken([&](MissionRecord& r) { r.steps[3].z_m = z_m; }), Invariant::kPositionInWorld) << z_m;
  EXPECT_EQ(Broken([](MissionRecord& r) { r.start_z_m = -1; }), Invariant::kPositionInWorld);
  EXPECT_EQ(Broken([](MissionRecord& r) { r.steps[3].x_m = 401; }, 1.0), std::nullopt) << "carried by a gust";
}

TEST_F(InvariantsTest, AScoreThatIsNoProbability) {
  for (double TimestepRecord::*field :
       {&TimestepRecord::scs, &TimestepRecord::fire_only_scs, &TimestepRecord::confidence_mean,
        &TimestepRecord::confidence_sd, &TimestepRecord::fire_share, &TimestepRecord::smoke_share,
        &TimestepRecord::epsilon})
    for (const double value : {-1e-6, 1.000001})
      EXPECT_EQ(Broken([&](MissionRecord& r) { r.steps[3].*field = value; }), Invariant::kProbabilityInRange);
}

TEST_F(InvariantsTest, AMissionWithoutAnEnd) {
  config_.mission.max_timesteps = 3;
  try {
    FlyMission({.scene = scene_, .config = config_, .seed = 5, .scenario = 3});
    ADD_FAILURE() << "not noticed";
  } catch (const BrokenInvariant& error) {
    EXPECT_EQ(error.Which(), Invariant::kMissionEnds);
  }
}

}  // namespace
}  // namespace ed3r::mission
