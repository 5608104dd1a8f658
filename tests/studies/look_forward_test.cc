// Errors of the predicted reward, by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "studies/tables/look_forward_table.h"

namespace ed3r {
namespace {

// Missions of ten predictions each; mean errors as given, the last missions the longest.
ArmData Arm(const std::string& name, const std::vector<double>& mean_errors) {
  ArmData arm{.stage = "online", .name = name, .missions = {}};
  for (std::size_t i = 0; i < mean_errors.size(); ++i) {
    MissionRecord mission;
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
  const std::vector<ArmData> arms = {Arm("ed3r-75", {0.4, 0.2, 0.2, 0.2, 0.2, 0.1, 0.1}),
                                     Arm("ecd2r", {0.8, 0.8, 0.8, 0.8, 0.8, 0.8, 0.8})};
  const std::vector<LookForward> rows = LookForwardOf(arms);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].mean_error, 0.2, 1e-12);
  EXPECT_NEAR(rows[0].largest_mission, 0.4, 1e-12);
  EXPECT_NEAR(rows[0].largest_timestep, 1.2, 1e-12);
  EXPECT_NEAR(rows[0].accuracy[static_cast<int>(WorstOf::kArm)], 50.0, 1e-9);
  EXPECT_NEAR(rows[0].accuracy[static_cast<int>(WorstOf::kAllArms)], 75.0, 1e-9);
  EXPECT_NEAR(rows[0].p85_accuracy[static_cast<int>(WorstOf::kGroup)], 0.0, 1e-9);
  EXPECT_NEAR(rows[0].p85_accuracy[static_cast<int>(WorstOf::kArm)], 75.0, 1e-9);
  EXPECT_NEAR(rows[1].accuracy[static_cast<int>(WorstOf::kAllArms)], 0.0, 1e-9);
}

TEST(LookForwardTest, ThePapersPatternIsAskedOfTheNumbers) {
  std::vector<ArmData> arms = {Arm("ed3r-75", {0.4, 0.2, 0.2, 0.2, 0.2, 0.1, 0.1})};
  EXPECT_FALSE(GivesThePapersPattern(LookForwardOf(arms), WorstOf::kArm)) << "no ablations";
  for (const char* name : {"ablation-1", "ablation-2", "ablation-3", "ablation-4"})
    arms.push_back(Arm(name, {0.4, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}));
  const std::vector<LookForward> rows = LookForwardOf(arms);
  EXPECT_TRUE(GivesThePapersPattern(rows, WorstOf::kArm));
  EXPECT_FALSE(GivesThePapersPattern(rows, WorstOf::kGroup)) << "a group of one is its own worst mission";
  EXPECT_NE(LookForwardText(rows).find("the arm's worst mission"), std::string::npos);
}

TEST(LookForwardTest, NothingWithoutPredictions) {
  ArmData walk = Arm("rbs", {0.1});
  walk.missions[0].predicted_timesteps = 0;
  EXPECT_TRUE(LookForwardOf(std::vector<ArmData>{walk}).empty());
  EXPECT_EQ(LookForwardText({}), "");
}

}  // namespace
}  // namespace ed3r
