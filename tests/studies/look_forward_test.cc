// Errors of the predicted reward, by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "studies/tables/look_forward_table.h"

namespace ed3r {
namespace {

// Missions of ten predictions each; mean errors as given, the last missions the longest.
metrics::ArmData Arm(const std::string& name, const std::vector<double>& mean_errors) {
  metrics::ArmData arm{.stage = "online", .name = name, .missions = {}};
  for (std::size_t i = 0; i < mean_errors.size(); ++i) {
    mission::MissionRecord mission;
    mission.network = 0;
    mission.duration_s = 100.0 + static_cast<double>(i);
    mission.predicted_timesteps = 10;
    mission.absolute_reward_error_sum = 10 * mean_errors[i];
    mission.largest_reward_error = 3 * mean_errors[i];
    arm.missions.push_back(mission);
  }
  return arm;
}

TEST(LookForwardTest, ErrorsAndThreeDefinitions) {
  // Seven missions: P85 is the longest one.
  const std::vector<metrics::ArmData> arms = {Arm("ed3r-75", {0.4, 0.2, 0.2, 0.2, 0.2, 0.1, 0.1}),
                                              Arm("ecd2r", {0.8, 0.8, 0.8, 0.8, 0.8, 0.8, 0.8})};
  const std::vector<tables::LookForward> rows = tables::LookForwardOf(arms);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].mean_error, 0.2, 1e-12);
  EXPECT_NEAR(rows[0].largest_mission, 0.4, 1e-12);
  EXPECT_NEAR(rows[0].largest_timestep, 1.2, 1e-12);
  EXPECT_NEAR(rows[0].accuracy[static_cast<int>(tables::WorstOf::kArm)], 50.0, 1e-9);
  EXPECT_NEAR(rows[0].accuracy[static_cast<int>(tables::WorstOf::kAllArms)], 75.0, 1e-9);
  EXPECT_NEAR(rows[0].p85_accuracy[static_cast<int>(tables::WorstOf::kGroup)], 0.0, 1e-9);
  EXPECT_NEAR(rows[0].p85_accuracy[static_cast<int>(tables::WorstOf::kArm)], 75.0, 1e-9);
  // Single timesteps are off by three times the mean: 1.2 at most here, 2.4 in the other arm.
  EXPECT_NEAR(rows[0].accuracy[static_cast<int>(tables::WorstOf::kArmTimestep)], 100 * (1 - 0.2 / 1.2), 1e-9);
  EXPECT_NEAR(rows[0].p85_accuracy[static_cast<int>(tables::WorstOf::kAllTimesteps)], 100 * (1 - 0.1 / 2.4),
              1e-9);
  EXPECT_NEAR(rows[1].accuracy[static_cast<int>(tables::WorstOf::kAllArms)], 0.0, 1e-9);
}

TEST(LookForwardTest, ThePapersPatternIsAskedOfTheNumbers) {
  std::vector<metrics::ArmData> arms = {Arm("ed3r-75", {0.4, 0.2, 0.2, 0.2, 0.2, 0.1, 0.1})};
  EXPECT_EQ(tables::PatternOf(tables::LookForwardOf(arms), tables::WorstOf::kArm).ablations_above_ed3r,
            std::nullopt);
  EXPECT_EQ(tables::PatternOf(tables::LookForwardOf(arms), tables::WorstOf::kArm).p85_above_mean,
            std::nullopt);
  for (const char* name : {"ablation-1", "ablation-2", "ablation-3", "ablation-4"})
    arms.push_back(Arm(name, {0.4, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}));
  arms.push_back(Arm("ecd2r", {0.8, 0.4, 0.4, 0.4, 0.4, 0.4, 0.1}));
  const std::vector<tables::LookForward> rows = tables::LookForwardOf(arms);
  const tables::LookForwardPattern by_arm = tables::PatternOf(rows, tables::WorstOf::kArm);
  EXPECT_EQ(by_arm.p85_above_mean, true);
  EXPECT_EQ(by_arm.ablations_above_ed3r, true);
  EXPECT_EQ(by_arm.ecd2r_above_ed3r, false) << "0.41 / 0.8 is more than 0.2 / 0.4";
  EXPECT_FALSE(by_arm.Holds());
  EXPECT_EQ(tables::PatternOf(rows, tables::WorstOf::kGroup).p85_above_mean, false)
      << "a group of one is its own worst mission";
  EXPECT_NE(tables::LookForwardText(rows).find("the arm's worst mission"), std::string::npos);
  EXPECT_EQ(tables::LookForwardJson(rows)["pattern"]["arm"]["ecd2r_above_ed3r"], false);
}

TEST(LookForwardTest, WhatIsNotThereIsEmpty) {
  std::vector<metrics::ArmData> arms = {Arm("ed3r-75", {0.4, 0.2, 0.2, 0.2, 0.2, 0.1, 0.1})};
  arms[0].missions.back().predicted_timesteps = 0;  // the P85 group has no prediction
  const std::vector<tables::LookForward> rows = tables::LookForwardOf(arms);
  EXPECT_TRUE(std::isnan(rows[0].p85_accuracy[0]));
  EXPECT_EQ(tables::LookForwardCsv(rows).find("nan"), std::string::npos);
  EXPECT_TRUE(nlohmann::ordered_json::parse(
                  tables::LookForwardJson(rows).dump())["arms"]["ed3r-75"]["p85_accuracy_pct"]["arm"]
                  .is_null());
}

TEST(LookForwardTest, NothingWithoutPredictions) {
  metrics::ArmData walk = Arm("rbs", {0.1});
  walk.missions[0].predicted_timesteps = 0;
  EXPECT_TRUE(tables::LookForwardOf(std::vector<metrics::ArmData>{walk}).empty());
  EXPECT_EQ(tables::LookForwardText({}), "");
}

}  // namespace
}  // namespace ed3r
