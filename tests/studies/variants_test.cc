// Variants of a study, paired by scenario.
#include "studies/variants/variants.h"

#include <gtest/gtest.h>

namespace ed3r {
namespace {

MissionRecord MissionOf(std::int64_t scenario, double energy_kj, Outcome outcome, std::int64_t network = -1) {
  MissionRecord mission;
  mission.scenario = scenario;
  mission.network = network;
  mission.timesteps = mission.full_local = 1;
  mission.duration_s = 60.0 * energy_kj;
  mission.total_j = mission.movement_j = 1000.0 * energy_kj;
  mission.outcome = static_cast<std::int64_t>(outcome);
  return mission;
}

// Scenario i costs 10 + i kJ in the base and 2 kJ more in the variant, which flies them the other way round and fails
// where i is odd.
std::vector<ArmData> Study() {
  ArmData base{"online", "rbs@base", {}}, heavy{"online", "rbs@heavy", {}};
  for (int i = 0; i < 10; ++i) base.missions.push_back(MissionOf(i, 10 + i, Outcome::kSuccess));
  for (int i = 9; i >= 0; --i)
    heavy.missions.push_back(
        MissionOf(i, 12 + i, i % 2 == 0 ? Outcome::kSuccess : Outcome::kBatteryDepleted));
  return {base, heavy};
}

TEST(VariantsTest, ArmsFindTheirVariants) {
  EXPECT_EQ(VariantsOf(Study()), (std::vector<std::string>{"base", "heavy"}));
  const std::vector<ArmData> heavy = ArmsOfVariant(Study(), "heavy");
  ASSERT_EQ(heavy.size(), 1u);
  EXPECT_EQ(heavy[0].name, "rbs");
  EXPECT_EQ(heavy[0].missions.front().scenario, 9);
}

TEST(VariantsTest, DifferencesArePairedByScenario) {
  const VariantStudy study = CompareVariants(Study());
  ASSERT_EQ(study.differences.size(), 3u);
  const VariantDifference& energy = study.differences[0];
  EXPECT_EQ(energy.metric, "total_energy_kj");
  EXPECT_NEAR(energy.base, 14.5, 1e-12);
  EXPECT_NEAR(energy.difference, 2.0, 1e-12);
  EXPECT_NEAR(energy.hi - energy.lo, 0.0, 1e-9)
      << "every pair differs by the same: unpaired it would be several kJ";
  EXPECT_EQ(energy.pairs, 10);
  const VariantDifference& success = study.differences[1];
  EXPECT_NEAR(success.difference, -50.0, 1e-12);
  EXPECT_LT(success.lo, -50.0);
  EXPECT_GT(success.hi, -50.0);
  EXPECT_NE(VariantText(study).find("rbs"), std::string::npos);
  EXPECT_EQ(DifferenceCsv(study).substr(0, 50), "arm,variant,metric,base,difference,lo,hi,pairs\nrbs");
}

TEST(VariantsTest, ScenariosThatOneDidNotFlyAreLeftOut) {
  std::vector<ArmData> arms = Study();
  arms[1].missions.resize(4);  // scenarios 9, 8, 7, 6
  const VariantStudy study = CompareVariants(arms);
  EXPECT_EQ(study.differences[0].pairs, 4);
  EXPECT_NEAR(study.differences[0].base, 17.5, 1e-12);
}

TEST(VariantsTest, NetworksThatDisagreeWidenTheInterval) {
  ArmData base{"online", "ed3r-75@a", {}}, other{"online", "ed3r-75@b", {}};
  for (int i = 0; i < 100; ++i) {
    base.missions.push_back(MissionOf(i, 20, Outcome::kSuccess, i % 2));
    other.missions.push_back(MissionOf(i, i % 2 == 0 ? 21 : 25, Outcome::kSuccess, i % 2));
  }
  const VariantDifference energy = CompareVariants(std::vector{base, other}).differences[0];
  EXPECT_NEAR(energy.difference, 3.0, 1e-12);
  EXPECT_LT(energy.lo, 0.0) << "two networks that differ by 4 kJ say nothing of the next one";
}

TEST(VariantsTest, RunsFlownApartAreComparedAsVariants) {
  std::vector<ArmData> arms = AsVariant({{"online", "rbs", {MissionOf(3, 20, Outcome::kSuccess)}}}, "one");
  for (ArmData& arm : AsVariant({{"online", "rbs", {MissionOf(3, 26, Outcome::kSuccess)}}}, "two"))
    arms.push_back(arm);
  const VariantStudy study = CompareVariants(arms);
  EXPECT_EQ(study.variants, (std::vector<std::string>{"one", "two"}));
  EXPECT_NEAR(study.differences.at(0).difference, 6.0, 1e-12);
}

TEST(VariantsTest, AChangeFromOrToUndecidedIsNoContradiction) {
  EXPECT_TRUE((VerdictChange{"C1", "b", Verdict::kNotDecidable, Verdict::kDiffers}.Undecided()));
  EXPECT_TRUE((VerdictChange{"C1", "b", Verdict::kReproduced, Verdict::kNotDecidable}.Undecided()));
  EXPECT_FALSE((VerdictChange{"C1", "b", Verdict::kReproduced, Verdict::kDiffers}.Undecided()));
}

TEST(VariantsTest, AStudyWithoutVariantsHasNone) {
  const VariantStudy study = CompareVariants(std::vector{ArmData{"online", "rbs", {}}});
  EXPECT_TRUE(study.variants.empty());
  EXPECT_EQ(VariantText(study), "");
}

}  // namespace
}  // namespace ed3r
