// Missions side by side: a row depends on its tasks and its actions alone; Gymnasium's three ways to begin again.
#include "engine/schedule/fleet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "engine/core/check.h"
#include "engine/store/digest.h"
#include "tests/mission/small_world.h"

namespace ed3r::schedule {
namespace {

class FleetTest : public ::testing::Test {
 protected:
  void SetUp() override {
    config_.mission.strategy = "external";
    config_.robot.battery_mah = 800;  // short missions
  }

  mission::MissionTask Task(std::int64_t mission) const {
    mission::MissionTask task{.scene = scene_, .config = config_};
    task.seed = 5;
    task.mission = static_cast<int>(mission);
    task.scenario = static_cast<std::uint32_t>(mission);
    return task;
  }

  // A policy that depends on what is seen alone: turns, and goes where it looks.
  static void Decide(const Fleet& fleet, std::vector<float>& commands,
                     std::vector<std::int64_t>& executions) {
    for (std::size_t row = 0; row < fleet.rows(); ++row) {
      const float* seen = fleet.Now().controller.data() + row * rfnn::kRcStates;
      float* command = commands.data() + row * kCommandValues;
      command[0] = 10 * std::cos(seen[rfnn::kRcYaw]), command[1] = 10 * std::sin(seen[rfnn::kRcYaw]);
      command[2] = 0, command[3] = 0.5, command[4] = seen[rfnn::kRcPreviousScs];
      executions[row] = fleet.Now().timestep[row] % 3;
    }
  }

  // Digest of each of `missions` missions, flown `rows` at a time.
  std::map<int, std::string> Fly(std::int64_t missions, std::size_t rows, int threads) const {
    Fleet fleet(
        rows,
        [&](std::size_t row, std::int64_t nth) -> std::optional<mission::MissionTask> {
          const std::int64_t mission = static_cast<std::int64_t>(row) + nth * static_cast<std::int64_t>(rows);
          if (mission >= missions) return std::nullopt;
          return Task(mission);
        },
        threads, Autoreset::kSameStep);
    std::map<int, std::string> digests;
    fleet.OnRecord([&](const mission::MissionTask& task, std::optional<mission::MissionRecord> record) {
      EXPECT_TRUE(digests.emplace(task.mission, store::DigestOf(record.value())).second);
    });
    fleet.Reset();
    std::vector<float> commands(rows * kCommandValues);
    std::vector<std::int64_t> executions(rows);
    while (static_cast<std::int64_t>(digests.size()) < missions) {
      Decide(fleet, commands, executions);
      fleet.Move(commands);
      fleet.Detect(executions);
    }
    for (const std::int64_t mission : fleet.Now().mission) EXPECT_EQ(mission, -1);  // all have retired
    return digests;
  }

  std::unique_ptr<Fleet> TwoRows(Autoreset autoreset) const {
    auto fleet = std::make_unique<Fleet>(
        2,
        [&](std::size_t row, std::int64_t nth) {
          return std::optional(Task(static_cast<std::int64_t>(row) + 2 * nth));
        },
        1, autoreset);
    fleet->Reset();
    return fleet;
  }

  static void Step(Fleet& fleet) {
    std::vector<float> commands(fleet.rows() * kCommandValues);
    std::vector<std::int64_t> executions(fleet.rows());
    Decide(fleet, commands, executions);
    fleet.Move(commands);
    fleet.Detect(executions);
  }

  // Until row 0 has ended.
  static void FlyOut(Fleet& fleet) {
    for (int k = 0; k < 1000 && fleet.Now().terminated[0] == 0; ++k) Step(fleet);
    ASSERT_EQ(fleet.Now().terminated[0], 1);
  }

  world::Scene scene_{mission::FlatParts()};
  Config config_;
};

TEST_F(FleetTest, RowsAndThreadsChangeNothing) {
  const std::map<int, std::string> alone = Fly(7, 1, 1);
  EXPECT_EQ(alone.size(), 7u);
  EXPECT_EQ(Fly(7, 3, 1), alone);
  EXPECT_EQ(Fly(7, 7, 2), alone);
  EXPECT_EQ(Fly(7, 5, 2), alone);
}

TEST_F(FleetTest, NextStepBeginsTheNextMissionAndNothingElse) {
  const auto fleet = TwoRows(Autoreset::kNextStep);
  FlyOut(*fleet);
  EXPECT_EQ(fleet->Now().mission[0], 0);
  EXPECT_GE(fleet->Now().outcome[0], 0);
  Step(*fleet);
  EXPECT_EQ(fleet->Now().mission[0], 2);
  EXPECT_EQ(fleet->Now().timestep[0], 1);
  EXPECT_EQ(fleet->Now().begun[0], 1);
  EXPECT_EQ(fleet->Now().reward[0], 0.0);
  EXPECT_EQ(fleet->Now().terminated[0], 0);
  Step(*fleet);
  EXPECT_EQ(fleet->Now().begun[0], 0);
  EXPECT_EQ(fleet->Now().timestep[0], 2);
}

TEST_F(FleetTest, SameStepShowsTheNextMissionAndKeepsTheEnd) {
  const auto fleet = TwoRows(Autoreset::kSameStep);
  FlyOut(*fleet);
  EXPECT_EQ(fleet->Now().mission[0], 2);
  EXPECT_EQ(fleet->Now().timestep[0], 1);
  EXPECT_LT(fleet->Now().reward[0], 0.0);  // of the mission that ended
  EXPECT_EQ(fleet->Final().mission[0], 0);
  EXPECT_GE(fleet->Final().outcome[0], 0);
  Step(*fleet);
  EXPECT_EQ(fleet->Now().terminated[0], 0);
  EXPECT_EQ(fleet->Now().timestep[0], 2);
}

TEST_F(FleetTest, StepsSumToTheRecordAlsoWhereTheBatteryCannotPay) {
  config_.robot.battery_mah = 300;
  const auto fleet = TwoRows(Autoreset::kDisabled);
  std::optional<mission::MissionRecord> flown;
  fleet->OnRecord([&](const mission::MissionTask& task, std::optional<mission::MissionRecord> record) {
    if (task.mission == 0) flown = std::move(record);
  });
  double total_j = 0.0, duration_s = 0.0;
  std::int64_t paid = 0;
  while (!flown) {
    Step(*fleet);
    total_j += fleet->Now().total_j[0], duration_s += fleet->Now().duration_s[0];
    paid += fleet->Now().paid[0];
  }
  ASSERT_EQ(flown->outcome, static_cast<std::int64_t>(mission::Outcome::kBatteryDepleted));
  EXPECT_DOUBLE_EQ(total_j, flown->total_j);
  EXPECT_DOUBLE_EQ(duration_s, flown->duration_s);
  EXPECT_EQ(paid, flown->timesteps);
  EXPECT_EQ(fleet->Now().paid[0], 0);
  EXPECT_EQ(fleet->Now().execution[0], -1);
  EXPECT_LT(fleet->Now().reward[0], 0.0);
  EXPECT_DOUBLE_EQ(fleet->Now().battery_j[0], flown->battery_left_j);
}

TEST_F(FleetTest, DisabledWaitsForAReset) {
  const auto fleet = TwoRows(Autoreset::kDisabled);
  FlyOut(*fleet);
  const std::int64_t other = fleet->Now().mission[1];
  Step(*fleet);
  EXPECT_EQ(fleet->Now().mission[0], 0);
  EXPECT_EQ(fleet->Now().terminated[0], 1);
  fleet->Reset(std::vector<std::uint8_t>{1, 0});
  EXPECT_EQ(fleet->Now().mission[0], 2);
  EXPECT_EQ(fleet->Now().mission[1], other);
}

TEST_F(FleetTest, RowsBeginFromTheirFirstMissionByThemselves) {
  const auto fleet = TwoRows(Autoreset::kDisabled);
  fleet->Reset();
  EXPECT_EQ(fleet->Now().mission, (std::vector<std::int64_t>{2, 3}));
  fleet->Reset({}, std::vector<std::uint8_t>{0, 1});
  EXPECT_EQ(fleet->Now().mission, (std::vector<std::int64_t>{4, 1}));
  fleet->Reset(std::vector<std::uint8_t>{1, 0}, std::vector<std::uint8_t>{1, 1});
  EXPECT_EQ(fleet->Now().mission, (std::vector<std::int64_t>{0, 1}));
}

TEST_F(FleetTest, WrongActionsAreRefusedBeforeAnythingMoves) {
  const auto fleet = TwoRows(Autoreset::kNextStep);
  std::vector<float> commands(2 * kCommandValues);
  commands[7] = NAN;
  EXPECT_THROW(fleet->Move(commands), UserError);
  commands[7] = 0;
  fleet->Move(commands);
  EXPECT_THROW(fleet->Detect(std::vector<std::int64_t>{0, 3}), UserError);
  fleet->Detect(std::vector<std::int64_t>{0, 2});
  EXPECT_EQ(fleet->Now().timestep, (std::vector<std::int64_t>{2, 2}));
}

TEST_F(FleetTest, ALimitTruncates) {
  config_.mission.max_timesteps = 2;
  const auto fleet = TwoRows(Autoreset::kDisabled);
  Step(*fleet);
  EXPECT_EQ(fleet->Now().truncated[0], 0);
  Step(*fleet);
  EXPECT_EQ(fleet->Now().truncated[0], 1);
  EXPECT_EQ(fleet->Now().outcome[0], -1);
}

}  // namespace
}  // namespace ed3r::schedule
