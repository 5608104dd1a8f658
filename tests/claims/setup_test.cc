#include "studies/claims/setup.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"
#include "tests/claims/synthetic_run.h"

namespace ed3r::claims {
namespace {

const paper::Claim& Find(const std::string& id) {
  for (const paper::Claim& claim : paper::PaperClaims())
    if (claim.id == id) return claim;
  throw std::out_of_range(id);
}

metrics::ArmData Warmup(int missions, int sites, std::int64_t timesteps) {
  metrics::ArmData arm{.stage = "warmup", .name = "warmup", .missions = {}};
  for (int i = 0; i < missions; ++i) {
    mission::MissionRecord& m = arm.missions.emplace_back();
    m.site = i % sites;
    m.timesteps = m.full_local = timesteps + (i % 2 == 0 ? 1 : -1);
  }
  return arm;
}

TEST(SetupTest, AsInThePaper) {
  const std::vector<metrics::ArmData> arms = {Warmup(2040, 6, 56), MakeArm({"ed3r-75"}, {.missions = 850})};
  for (const char* id : {"C004", "C005", "C007", "C008", "C009"})
    EXPECT_EQ(JudgeSetup(Find(id), arms).verdict, Verdict::kReproduced) << id;
  const Judgement samples = JudgeSetup(Find("C006"), arms);
  EXPECT_EQ(samples.ours, 2040 * 56);
  EXPECT_EQ(samples.verdict, Verdict::kDiffers);  // 114,240 +- 90: 115K is 114.5 to 115.5 thousand
}

TEST(SetupTest, OtherStudies) {
  const std::vector<metrics::ArmData> arms = {Warmup(60, 5, 56), MakeArm({"ed3r-75"}, {.missions = 850}),
                                              MakeArm({"rbs"}, {.missions = 56})};
  const Judgement missions = JudgeSetup(Find("C004"), arms);
  EXPECT_EQ(missions.verdict, Verdict::kNotMeasured);   // a shorter run contradicts nothing
  EXPECT_EQ(missions.ours, 56);                         // the arm with the fewest
  EXPECT_EQ(JudgeSetup(Find("C034"), arms).ours, 850);  // the thresholds only
  EXPECT_EQ(JudgeSetup(Find("C005"), arms).ours, 60);
  EXPECT_EQ(JudgeSetup(Find("C005"), arms).verdict, Verdict::kNotMeasured);
  EXPECT_EQ(JudgeSetup(Find("C006"), arms).verdict, Verdict::kNotMeasured);
  EXPECT_EQ(JudgeSetup(Find("C007"), arms).verdict, Verdict::kDiffers);
}

TEST(SetupTest, AnUnfinishedRunIsNotOneOfAnotherLength) {
  std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75"}, {.missions = 849})};
  EXPECT_EQ(JudgeSetup(Find("C004"), arms).why, "another number of missions than in the paper, on purpose");
  arms[0].failed = 1;
  EXPECT_EQ(JudgeSetup(Find("C004"), arms).why, "missions are missing or failed");
}

TEST(SetupTest, WithoutTheArms) {
  EXPECT_EQ(JudgeSetup(Find("C005"), {}).verdict, Verdict::kNotMeasured);
  EXPECT_EQ(JudgeSetup(Find("C004"), {}).why, "not in this run: the online arms");
  const std::vector<metrics::ArmData> arms = {Warmup(60, 6, 56)};
  EXPECT_EQ(JudgeSetup(Find("C007"), arms).verdict, Verdict::kNotMeasured);
}

TEST(SetupTest, UnknownFactsAreBrokenInvariants) {
  paper::Claim claim = Find("C005");
  claim.metric = "wings";
  const std::vector<metrics::ArmData> arms = {Warmup(60, 6, 56)};
  EXPECT_THROW(JudgeSetup(claim, arms), InternalError);
}

}  // namespace
}  // namespace ed3r::claims
