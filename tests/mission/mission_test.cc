// Whole missions over a small world: ledger, outcomes, common random numbers.
#include "engine/mission/mission.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/check.h"
#include "engine/core/interrupt.h"
#include "engine/robot/energy.h"
#include "tests/mission/small_world.h"

namespace ed3r::mission {
namespace {

class MissionTest : public ::testing::Test {
 protected:
  MissionRecord Fly(const std::string& strategy, std::uint32_t scenario,
                    const std::atomic<bool>* stop = nullptr) {
    config_.mission.strategy = strategy;
    MissionTask task{.scene = scene_, .config = config_};
    task.seed = 5;
    task.scenario = scenario;
    task.stop = stop;
    return FlyMission(task);
  }

  world::Scene scene_{FlatParts()};
  Config config_;
};

TEST_F(MissionTest, ARandomWalkFliesUntilTheBatteryCannotPay) {
  const MissionRecord record = Fly("random", 3);
  EXPECT_EQ(record.outcome, static_cast<std::int64_t>(Outcome::kBatteryDepleted));
  EXPECT_GT(record.timesteps, 30);
  EXPECT_GE(record.battery_left_j, 0.0);
  EXPECT_LT(record.battery_left_j, 12000.0);  // less than the dearest timestep
  EXPECT_EQ(record.contact_steps, 0);
  EXPECT_NEAR(record.total_j + record.battery_left_j, 139860.0, 139860.0 * 1e-9);
  double sum_j = 0.0;
  for (const TimestepRecord& step : record.steps) sum_j += step.total_j;
  EXPECT_NEAR(sum_j, record.total_j, record.total_j * 1e-12);
}

TEST_F(MissionTest, RbsFindsTheFireAndCompletesFromAHover) {
  int successes = 0;
  for (std::uint32_t scenario = 0; scenario < 12; ++scenario) {
    const MissionRecord record = Fly("rbs", scenario);
    if (record.outcome != static_cast<std::int64_t>(Outcome::kSuccess)) continue;
    ++successes;
    ASSERT_GE(record.steps.size(), 2u);
    const TimestepRecord& last = record.steps.back();
    const TimestepRecord& before = record.steps[record.steps.size() - 2];
    EXPECT_GE(last.scs, config_.agents.eta_min);
    EXPECT_GE(before.scs, config_.agents.eta_min);
    EXPECT_EQ(last.motion_rule, static_cast<std::int64_t>(agents::MotionRule::kHover));
    EXPECT_EQ(last.horizontal_s + last.ascent_s + last.descent_s, 0.0);
    EXPECT_TRUE(last.fire_in_view || before.fire_in_view);
  }
  EXPECT_GE(successes, 4);
}

// Arms that fly a scenario meet the same start, site and draws, whatever they do (common random numbers).
TEST_F(MissionTest, ArmsMeetTheSameNature) {
  const MissionRecord walk = Fly("random", 2);
  const MissionRecord rules = Fly("rbs", 2);
  EXPECT_EQ(walk.site, rules.site);
  EXPECT_EQ(walk.start_x_m, rules.start_x_m);
  for (std::size_t k = 0; k < std::min(walk.steps.size(), rules.steps.size()); ++k) {
    EXPECT_EQ(walk.steps[k].cpu_hz, rules.steps[k].cpu_hz);
    EXPECT_EQ(walk.steps[k].bandwidth_hz, rules.steps[k].bandwidth_hz);
    EXPECT_EQ(walk.steps[k].shadowing_db, rules.steps[k].shadowing_db);
  }
}

// R16: a completion that fire and smoke alone would have reached is a success, any other a false positive.
TEST_F(MissionTest, AFalsePositiveWouldNotHaveCompletedWithoutDistractors) {
  config_.perception.distractors_per_km2 = 4000;
  int false_positives = 0;
  for (std::uint32_t scenario = 0; scenario < 20; ++scenario) {
    const MissionRecord record = Fly("rbs", scenario);
    if (record.outcome == static_cast<std::int64_t>(Outcome::kBatteryDepleted)) continue;
    const bool false_positive = record.outcome == static_cast<std::int64_t>(Outcome::kFalsePositive);
    false_positives += false_positive ? 1 : 0;
    const TimestepRecord& last = record.steps.back();
    const TimestepRecord& first = record.steps[record.steps.size() - 2];
    for (const TimestepRecord* step : {&first, &last}) {
      EXPECT_GE(step->scs, config_.agents.eta_min);
      EXPECT_LE(step->fire_only_scs, step->scs);
    }
    EXPECT_EQ(std::min(first.fire_only_scs, last.fire_only_scs) < config_.agents.eta_min, false_positive);
  }
  EXPECT_GT(false_positives, 3);
}

TEST_F(MissionTest, MechanismsCanBeSwitchedOff) {
  config_.agents.early_completion = false;
  EXPECT_EQ(Fly("rbs", 0).outcome, static_cast<std::int64_t>(Outcome::kBatteryDepleted));
}

TEST_F(MissionTest, HoveringIsBilledWhileTheRobotWaits) {
  for (const TimestepRecord& step : Fly("random", 1).steps) {
    EXPECT_NEAR(step.hover_sensing_j, 3.0 * 135.3, 0.2);
    EXPECT_EQ(step.sensing_s, 3.0);
    if (step.execution == static_cast<std::int64_t>(agents::Execution::kOffload)) {
      EXPECT_EQ(step.computing_s, 0.0);
      EXPECT_GT(step.transmitting_s, 0.0);
      EXPECT_GT(step.hover_transmitting_j, 0.0);
    } else {
      EXPECT_EQ(step.transmission_j, 0.0);
      EXPECT_GT(step.hover_computing_j, 0.0);
    }
  }
}

// The mission itself refuses a ledger that does not add up (CheckLedger); here both models get that far.
TEST_F(MissionTest, EitherEnergyModelAddsUp) {
  const MissionRecord paper = Fly("random", 6);
  config_.energy.model = PowerModel::kMomentum;
  const MissionRecord momentum = Fly("random", 6);
  for (const MissionRecord* record : {&paper, &momentum}) {
    EXPECT_NEAR(record->movement_j + record->sensing_j + record->computation_j + record->transmission_j,
                record->total_j, 1e-9 * record->total_j);
    EXPECT_NEAR(record->total_j + record->battery_left_j, 139860.0, 139860.0 * 1e-9);
  }
  const TimestepRecord& climb = momentum.steps[0];
  EXPECT_NE(paper.steps[0].total_j, climb.total_j);
  // In momentum theory a climb costs more than hovering for as long, a descent less.
  const robot::MovementPower power =
      robot::MovementPowerOf(config_.robot, config_.environment, config_.energy);
  EXPECT_GT(power.ascent_w, power.hover_w);
  EXPECT_LT(power.descent_w, power.hover_w);
}

// Each leg at its own airspeed: the ledger is proven against them, and legs with the wind are cheaper than legs against it.
TEST_F(MissionTest, WindIsBilledWhereThePowersKnowIt) {
  config_.energy.model = PowerModel::kMomentum;
  config_.environment.wind_x_mps = 6.0;
  const robot::MovementPower power =
      robot::MovementPowerOf(config_.robot, config_.environment, config_.energy);
  const auto along_w = [&](double x) {
    return robot::MovementPowerOf(config_.robot, config_.environment, config_.energy, {x, 0}).horizontal_w;
  };
  const MissionRecord record = Fly("random", 3);
  double least_w = 1e9, most_w = 0.0;
  for (const TimestepRecord& step : record.steps) {
    EXPECT_NEAR(step.hover_sensing_j, power.hover_w * step.sensing_s, 1e-6);
    if (step.horizontal_s < 0.1) continue;
    const double here_w = step.horizontal_j / step.horizontal_s;
    least_w = std::min(least_w, here_w), most_w = std::max(most_w, here_w);
  }
  const double with_w = along_w(1), against_w = along_w(-1);
  EXPECT_GT(most_w - least_w, 0.5 * std::abs(against_w - with_w));
  EXPECT_LE(most_w, std::max({against_w, with_w, power.horizontal_w}) + 1e-9);
  config_.environment.wind_x_mps = 0.0;
  EXPECT_NE(Fly("random", 3).steps.front().hover_sensing_j, record.steps.front().hover_sensing_j);
}

TEST_F(MissionTest, TheSameTaskGivesTheSameBits) {
  const MissionRecord first = Fly("rbs", 4);
  const MissionRecord second = Fly("rbs", 4);
  ASSERT_EQ(first.steps.size(), second.steps.size());
  EXPECT_EQ(first.total_j, second.total_j);
  for (std::size_t k = 0; k < first.steps.size(); ++k) {
    EXPECT_EQ(first.steps[k].x_m, second.steps[k].x_m);
    EXPECT_EQ(first.steps[k].scs, second.steps[k].scs);
  }
}

TEST_F(MissionTest, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  EXPECT_THROW(Fly("random", 0, &stop), Interrupted);
}

TEST_F(MissionTest, AnEndlessMissionIsAFailure) {
  config_.mission.max_timesteps = 3;
  EXPECT_THROW(Fly("random", 0), InternalError);
}

}  // namespace
}  // namespace ed3r::mission
