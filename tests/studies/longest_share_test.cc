// The P85 group: the longest missions of an arm (R30).
#include <gtest/gtest.h>

#include "engine/core/check.h"
#include "studies/metrics/arm.h"
#include "studies/paper/arms.h"

namespace ed3r {
namespace {

metrics::ArmData ArmOf(const std::vector<double>& durations_s) {
  metrics::ArmData arm{.stage = "online", .name = "ed3r-75", .missions = {}, .failed = 1, .missing = 2};
  for (const double duration_s : durations_s) {
    mission::MissionRecord& mission = arm.missions.emplace_back();
    mission.scenario = static_cast<std::int64_t>(arm.missions.size()) - 1;
    mission.duration_s = duration_s;
  }
  return arm;
}

std::vector<std::int64_t> ScenariosOf(const metrics::ArmData& arm) {
  std::vector<std::int64_t> scenarios;
  for (const mission::MissionRecord& mission : arm.missions) scenarios.push_back(mission.scenario);
  return scenarios;
}

using Scenarios = std::vector<std::int64_t>;

TEST(LongestShareTest, KeepsTheLongestInMissionOrder) {
  EXPECT_EQ(ScenariosOf(metrics::LongestShare(ArmOf({10, 80, 30, 90, 20}), 40)), (Scenarios{1, 3}));
  EXPECT_EQ(ScenariosOf(metrics::LongestShare(ArmOf({10, 80, 30}), 100)), (Scenarios{0, 1, 2}));
  EXPECT_TRUE(metrics::LongestShare(ArmOf({10, 80, 30}), 0).missions.empty());
}

TEST(LongestShareTest, OfEqualOnesTheFirstCount) {
  EXPECT_EQ(ScenariosOf(metrics::LongestShare(ArmOf({5, 7, 7, 7, 1}), 40)), (Scenarios{1, 2}));
}

TEST(LongestShareTest, RoundsToTheNearestMission) {
  EXPECT_EQ(metrics::LongestShare(ArmOf(std::vector<double>(850, 1)), 15).missions.size(), 128u);  // 127.5
  EXPECT_EQ(metrics::LongestShare(ArmOf(std::vector<double>(56, 1)), 15).missions.size(), 8u);     // 8.4
  EXPECT_EQ(metrics::LongestShare(ArmOf({}), 15).missions.size(), 0u);
}

TEST(LongestShareTest, OtherSharesAreBrokenInvariants) {
  EXPECT_THROW(metrics::LongestShare(ArmOf({1}), 101), InternalError);
  EXPECT_THROW(metrics::LongestShare(ArmOf({1}), -1), InternalError);
}

TEST(P85GroupTest, HasThePapersName) {
  const metrics::ArmData group = metrics::P85Group(ArmOf(std::vector<double>(20, 1)));
  EXPECT_EQ(group.name, "ed3r-p85");
  EXPECT_EQ(group.stage, "online");
  EXPECT_EQ(group.missions.size(), 3u);
  EXPECT_EQ(group.failed + group.missing, 0);
  EXPECT_EQ(paper::P85Name("rbs"), "rbs-p85");
  EXPECT_EQ(paper::P85Name("ed3r-65"), "ed3r-65-p85");
}

}  // namespace
}  // namespace ed3r
