// The ledger check must notice what it is there for.
#include "engine/mission/accounts.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"
#include "engine/mission/invariants.h"

namespace ed3r::mission {
namespace {

constexpr double kBatteryJ = 139860.0;

MissionRecord OneStep(const robot::MovementPower& power) {
  robot::StepTime time;
  time.horizontal_s = 3.0;
  time.ascent_s = 1.0;
  time.descent_s = 0.5;
  time.turning_s = 0.2;
  time.sensing_s = 3.0;
  time.computing_s = 4.0;
  const robot::StepEnergy energy =
      robot::Charge(power, time, {.sensing_j = 22.2, .computation_j = 50, .transmission_j = 0});
  MissionRecord record;
  record.steps.emplace_back();
  record.battery_left_j = kBatteryJ - energy.TotalJ();
  RecordLedger(time, energy, record.battery_left_j, record.steps.back());
  SumSteps(0.75, record);
  return record;
}

TEST(LedgerTest, ATrueLedgerPasses) {
  const robot::MovementPower power = robot::MovementPowerOf({}, {}, {});
  const MissionRecord record = OneStep(power);
  EXPECT_NO_THROW(CheckLedger(record, power, kBatteryJ));
  EXPECT_NEAR(record.total_j, 139.85 * 3 + 23.73 + 11.86 / 2 + 135.3 * 7.2 + 72.2, 0.5);
}

TEST(LedgerTest, ALostPartIsFound) {
  const robot::MovementPower power = robot::MovementPowerOf({}, {}, {});
  MissionRecord record = OneStep(power);
  record.steps[0].total_j -= 1e-3;
  EXPECT_THROW(CheckLedger(record, power, kBatteryJ), InternalError);
}

TEST(LedgerTest, ABatteryThatDoesNotFollowIsFound) {
  const robot::MovementPower power = robot::MovementPowerOf({}, {}, {});
  MissionRecord record = OneStep(power);
  record.battery_left_j += 1e-3;
  EXPECT_THROW(CheckLedger(record, power, kBatteryJ), InternalError);
}

}  // namespace
}  // namespace ed3r::mission
