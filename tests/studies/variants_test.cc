// Variants of a study, paired by scenario.
#include "studies/variants/variants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "studies/statistics/intervals.h"
#include "studies/variants/paired.h"
#include "studies/variants/pairing_notes.h"
#include "tests/claims/synthetic_run.h"

namespace ed3r {
namespace {

mission::MissionRecord MissionOf(std::int64_t scenario, double energy_kj, mission::Outcome outcome,
                                 std::int64_t network = -1) {
  mission::MissionRecord mission;
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
std::vector<metrics::ArmData> Study() {
  metrics::ArmData base{"online", "rbs@base", {}}, heavy{"online", "rbs@heavy", {}};
  for (int i = 0; i < 10; ++i) base.missions.push_back(MissionOf(i, 10 + i, mission::Outcome::kSuccess));
  for (int i = 9; i >= 0; --i)
    heavy.missions.push_back(
        MissionOf(i, 12 + i, i % 2 == 0 ? mission::Outcome::kSuccess : mission::Outcome::kBatteryDepleted));
  return {base, heavy};
}

TEST(VariantsTest, ArmsFindTheirVariants) {
  EXPECT_EQ(variants::VariantsOf(Study()), (std::vector<std::string>{"base", "heavy"}));
  const std::vector<metrics::ArmData> heavy = variants::ArmsOfVariant(Study(), "heavy");
  ASSERT_EQ(heavy.size(), 1u);
  EXPECT_EQ(heavy[0].name, "rbs");
  EXPECT_EQ(heavy[0].missions.front().scenario, 9);
}

TEST(VariantsTest, OtherPlacesAreSaid) {
  std::vector<metrics::ArmData> arms = Study();
  EXPECT_TRUE(variants::VariantPairingNotes(arms).empty());
  arms[1].world = "with a larger fire";
  EXPECT_TRUE(variants::VariantPairingNotes(arms).empty()) << "the other one is not known";
  arms[0].world = "as it is";
  std::vector<std::string> notes = variants::VariantPairingNotes(arms);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].find("heavy: not the world of 'base'"), 0u) << notes[0];
  for (mission::MissionRecord& mission : arms[1].missions) mission.site += 1;
  notes = variants::VariantPairingNotes(arms);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].find("heavy: scenarios of one number begin elsewhere"), 0u) << notes[0];
}

TEST(VariantsTest, FewScenariosInCommonAreSaid) {
  std::vector<metrics::ArmData> arms = Study();
  arms[1].missions.pop_back();
  EXPECT_TRUE(variants::VariantPairingNotes(arms).empty()) << "one flew on";
  for (mission::MissionRecord& mission : arms[1].missions) mission.scenario += 5;
  const std::vector<std::string> notes = variants::VariantPairingNotes(arms);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].find("heavy: not all scenario numbers are those of 'base'"), 0u) << notes[0];
}

TEST(VariantsTest, DifferencesArePairedByScenario) {
  const variants::VariantStudy study = variants::CompareVariants(Study(), variants::Verdicts::kJudged);
  ASSERT_EQ(study.differences.size(), 3u);
  const variants::VariantDifference& energy = study.differences[0];
  EXPECT_EQ(energy.metric, "total_energy_kj");
  EXPECT_NEAR(energy.base, 14.5, 1e-12);
  EXPECT_NEAR(energy.difference, 2.0, 1e-12);
  EXPECT_NEAR(energy.hi - energy.lo, 0.0, 1e-9)
      << "every pair differs by the same: unpaired it would be several kJ";
  EXPECT_EQ(energy.pairs, 10);
  const variants::VariantDifference& success = study.differences[1];
  EXPECT_NEAR(success.difference, -50.0, 1e-12);
  EXPECT_LT(success.lo, -50.0);
  EXPECT_GT(success.hi, -50.0);
  EXPECT_NE(variants::VariantText(study).find("rbs"), std::string::npos);
  EXPECT_TRUE(energy.Certain()) << "a rule-based arm asks no network";
  EXPECT_EQ(variants::DifferenceCsv(study).substr(0, 73),
            "arm,variant,metric,base,difference,lo,hi,pairs,base_networks,networks\nrbs");
}

TEST(VariantsTest, ArmsOfOneNameInTwoStagesAreToldApart) {
  std::vector<metrics::ArmData> arms = Study();
  for (const std::size_t a : {0u, 1u}) {
    arms.push_back(arms[a]);
    arms.back().stage = "again";
  }
  const variants::VariantStudy study = variants::CompareVariants(arms, variants::Verdicts::kLeftOut);
  ASSERT_EQ(study.differences.size(), 6u);
  EXPECT_EQ(study.differences[0].arm, arms[0].stage + "/rbs");
  EXPECT_EQ(study.differences[3].arm, "again/rbs");
}

TEST(VariantsTest, LongNamesDoNotRunTogether) {
  std::vector<metrics::ArmData> arms = Study();
  const std::string arm = "random-offload", variant = "robot.mass_kg=3,robot.speed_mps=6.5";
  arms[0].name = arm + "@base", arms[1].name = arm + '@' + variant;
  const variants::VariantStudy study = variants::CompareVariants(arms, variants::Verdicts::kJudged);
  const std::string text = variants::VariantText(study);
  EXPECT_NE(text.find(arm + "  " + variant + "  "), std::string::npos) << text;
  // The headings stand over their columns.
  std::istringstream lines(text);
  std::string title, heading, rule, row;
  for (std::string* line : {&title, &heading, &rule, &row}) std::getline(lines, *line);
  EXPECT_EQ(heading.find("variant"), row.find(variant)) << text;
  EXPECT_EQ(heading.size(), row.size()) << text;
}

TEST(VariantsTest, OrdersThatChangeAreARowEach) {
  std::vector<metrics::ArmData> arms;
  for (const auto& [variant, energy_kj] : {std::pair("base", 20.0), std::pair("heavy", 60.0)})
    for (const metrics::ArmData& arm :
         {claims::MakeArm({"ed3r-75", energy_kj}), claims::MakeArm({"ecd2r", 25}),
          claims::MakeArm({"rbs", 35, 0.2, 0, false})})
      arms.push_back(variants::AsVariant({arm}, variant).front());
  const variants::VariantStudy study = variants::CompareVariants(arms, variants::Verdicts::kJudged);
  const std::string text = variants::VariantText(study);
  EXPECT_NE(text.find("C140 total energy: ed3r-75 < ecd2r, rbs                            +  -\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("C075"), std::string::npos) << "an order without its arms is alike in both";
  const std::size_t all = text.find("distinct claims hold in every variant:"),
                    none = text.find("hold in none:");
  ASSERT_NE(all, std::string::npos) << text;
  ASSERT_LT(all, none);
  EXPECT_EQ(text.find("C140 ", all), std::string::npos) << "it holds in one of the two";
  EXPECT_NE(variants::VariantVerdictCsv(study).find(
                "C140,ed3r-75 ecd2r rbs,total_energy_kj,order,\"ed3r-75 < ecd2r, "
                "rbs\",1,2,direction holds,differs\n"),
            std::string::npos)
      << variants::VariantVerdictCsv(study);
}

TEST(VariantsTest, ScenariosThatOneDidNotFlyAreLeftOut) {
  std::vector<metrics::ArmData> arms = Study();
  arms[1].missions.resize(4);  // scenarios 9, 8, 7, 6
  const variants::VariantStudy study = variants::CompareVariants(arms, variants::Verdicts::kJudged);
  EXPECT_EQ(study.differences[0].pairs, 4);
  EXPECT_NEAR(study.differences[0].base, 17.5, 1e-12);
}

TEST(VariantsTest, NetworksThatDisagreeWidenTheInterval) {
  metrics::ArmData base{"online", "ed3r-75@a", {}}, other{"online", "ed3r-75@b", {}};
  for (int i = 0; i < 100; ++i) {
    base.missions.push_back(MissionOf(i, 20, mission::Outcome::kSuccess, i % 2));
    other.missions.push_back(MissionOf(i, i % 2 == 0 ? 21 : 25, mission::Outcome::kSuccess, i % 2));
  }
  const variants::VariantDifference energy =
      variants::CompareVariants(std::vector{base, other}, variants::Verdicts::kJudged).differences[0];
  EXPECT_NEAR(energy.difference, 3.0, 1e-12);
  EXPECT_LT(energy.lo, 0.0) << "two networks that differ by 4 kJ say nothing of the next one";
}

TEST(VariantsTest, RunsFlownApartAreComparedAsVariants) {
  std::vector<metrics::ArmData> arms =
      variants::AsVariant({{"online", "rbs", {MissionOf(3, 20, mission::Outcome::kSuccess)}}}, "one");
  for (metrics::ArmData& arm :
       variants::AsVariant({{"online", "rbs", {MissionOf(3, 26, mission::Outcome::kSuccess)}}}, "two"))
    arms.push_back(arm);
  const variants::VariantStudy study = variants::CompareVariants(arms, variants::Verdicts::kJudged);
  EXPECT_EQ(study.variants, (std::vector<std::string>{"one", "two"}));
  EXPECT_NEAR(study.differences.at(0).difference, 6.0, 1e-12);
}

TEST(VariantsTest, OnlyHoldingAndDifferingContradict) {
  const auto contradicts = [](claims::Verdict a, claims::Verdict b) {
    return variants::VerdictChange{"C1", "b", a, b}.Contradicts();
  };
  EXPECT_TRUE(contradicts(claims::Verdict::kReproduced, claims::Verdict::kDiffers));
  EXPECT_TRUE(contradicts(claims::Verdict::kDiffers, claims::Verdict::kDirectionHolds));
  EXPECT_FALSE(contradicts(claims::Verdict::kReproduced, claims::Verdict::kDirectionHolds));
  EXPECT_FALSE(contradicts(claims::Verdict::kReproduced, claims::Verdict::kNotDecidable));
  EXPECT_FALSE(contradicts(claims::Verdict::kDiffers, claims::Verdict::kNotMeasured));
}

// 100 missions of `networks` networks, whose means lie 4 kJ apart.
metrics::ArmData FlownBy(const std::string& name, int networks, double energy_kj) {
  metrics::ArmData arm{"online", name, {}};
  for (int i = 0; i < 100; ++i)
    arm.missions.push_back(
        MissionOf(i, energy_kj + 4.0 * (i % networks), mission::Outcome::kSuccess, i % networks));
  return arm;
}

TEST(VariantsTest, ASingleNetworkMakesNothingCertain) {
  for (const auto& [base, other] : {std::pair{1, 1}, std::pair{1, 3}, std::pair{3, 1}}) {
    const variants::VariantStudy study = variants::CompareVariants(
        std::vector{FlownBy("ed3r-75@a", base, 20), FlownBy("ed3r-75@b", other, 60)},
        variants::Verdicts::kJudged);
    const variants::VariantDifference& energy = study.differences[0];
    EXPECT_GT(energy.lo, 0.0);
    EXPECT_FALSE(energy.Certain());
    const std::string text = variants::VariantText(study);
    EXPECT_NE(text.find("? one trained network"), std::string::npos) << text;
    EXPECT_EQ(text.find("* ["), std::string::npos) << text;
  }
}

TEST(VariantsTest, DifferentNumbersOfNetworksAreComparedByWelch) {
  const metrics::ArmData two = FlownBy("ed3r-75@a", 2, 20), five = FlownBy("ed3r-75@b", 5, 20);
  const auto width = [](const metrics::ArmData& a, const metrics::ArmData& b) {
    const variants::VariantDifference energy =
        variants::CompareVariants(std::vector{a, b}, variants::Verdicts::kJudged).differences[0];
    return energy.hi - energy.lo;
  };
  metrics::ArmData first = five, second = two;
  first.name = "ed3r-75@a";
  second.name = "ed3r-75@b";
  EXPECT_NEAR(width(two, five), width(first, second), 1e-9) << "whichever comes first";
  // Means 20, 24 and 20 .. 36: variances of their means 4 and 8, Welch's degrees 144 / (16 / 1 + 64 / 4) = 4.5.
  EXPECT_NEAR(width(two, five), 2.0 * statistics::StudentT95(4.5) * std::sqrt(12.0), 1e-9);
}

// Beside an arm that asks no network, the luck of the one that does is all the luck there is.
TEST(VariantsTest, TheLuckOfOneSideIsInTheInterval) {
  metrics::ArmData walk = FlownBy("rbs", 1, 20);
  for (mission::MissionRecord& mission : walk.missions) mission.network = -1;
  const metrics::ArmData trained = FlownBy("ed3r-75", 4, 21);
  // Networks 1, 5, 9 and 13 kJ dearer: a mean of 7, a standard deviation of sqrt(80 / 3).
  const double half = statistics::StudentT95(3) * std::sqrt(80.0 / 3.0 / 4.0);
  for (const bool walk_first : {true, false}) {
    const variants::PairedDifference energy = walk_first
                                                  ? variants::DifferenceOf(walk, trained, "total_energy_kj")
                                                  : variants::DifferenceOf(trained, walk, "total_energy_kj");
    EXPECT_NEAR(energy.difference, walk_first ? 7.0 : -7.0, 1e-9);
    EXPECT_NEAR(energy.hi - energy.lo, 2.0 * half, 1e-9);
    EXPECT_NEAR(energy.p, statistics::StudentP(7.0 / std::sqrt(80.0 / 3.0 / 4.0), 3), 1e-9);
    EXPECT_FALSE(energy.Certain());
  }
}

// Their luck adds nothing to that of the missions, to the interval as to p.
TEST(VariantsTest, NetworksWhoseMeansCoincideLeaveTheDecisionToTheMissions) {
  metrics::ArmData base{"online", "ed3r-75@a", {}}, other{"online", "ed3r-75@b", {}};
  std::vector<double> differences;
  for (int i = 0; i < 40; ++i) {
    const double more = 2.0 + (i / 2 % 2 == 0 ? 1.0 : -1.0);
    base.missions.push_back(MissionOf(i, 20, mission::Outcome::kSuccess, i % 2));
    other.missions.push_back(MissionOf(i, 20 + more, mission::Outcome::kSuccess, i % 2));
    differences.push_back(more);
  }
  const variants::PairedDifference energy = variants::DifferenceOf(base, other, "total_energy_kj");
  EXPECT_NEAR(energy.difference, 2.0, 1e-9);
  EXPECT_NEAR(energy.p, statistics::MeanP(differences), 1e-12);
  EXPECT_GT(energy.lo, 0.0);
  EXPECT_LT(energy.p, 1e-6);
}

TEST(VariantsTest, WhatAComparisonLeavesOutIsTold) {
  const std::vector<metrics::ArmData> first = {
      {"online",
       "rbs",
       {MissionOf(0, 1, mission::Outcome::kSuccess), MissionOf(1, 1, mission::Outcome::kSuccess)}},
      {"online", "mine", {MissionOf(0, 1, mission::Outcome::kSuccess)}}};
  std::vector<metrics::ArmData> other = {{"online", "rbs", {MissionOf(1, 2, mission::Outcome::kSuccess)}}};
  using Notes = std::vector<std::string>;
  EXPECT_EQ(variants::PairingNotes({"a", first}, {"b", other}, true),
            (Notes{"only a has mine (stage online): not compared",
                   "a and b, rbs: 1 scenario is in common, of 2 and 1"}));
  other[0].missions[0].site = 5;
  EXPECT_EQ(variants::PairingNotes({"a", first}, {"b", other}, true).size(), 3u);
  EXPECT_EQ(variants::PairingNotes({"a", first}, {"b", other}, false),
            (Notes{"only a has mine (stage online): not compared",
                   "a and b, rbs: 1 scenario number is in common, of 2 and 1"}))
      << "other seeds draw other places, but as few are compared";
  EXPECT_EQ(variants::PairingNotes({"a", first}, {"b", first}, true), Notes{});
}

// As many networks, that took turns otherwise: what they share cannot be taken out.
TEST(VariantsTest, NetworksThatDidNotMeetOneToOneAreComparedByWelch) {
  const metrics::ArmData base = FlownBy("ed3r-75@a", 2, 20);
  metrics::ArmData other = FlownBy("ed3r-75@b", 2, 20);
  for (std::size_t i = 0; i < other.missions.size(); ++i)
    if (i % 4 < 2) other.missions[i].network = 1 - other.missions[i].network;
  const variants::PairedDifference energy = variants::DifferenceOf(base, other, "total_energy_kj");
  EXPECT_EQ(energy.base_networks, 2);
  EXPECT_EQ(energy.networks, 2);
  EXPECT_GT(energy.hi - energy.lo, 20.0) << "means 20 and 24 of the one, equal ones of the other";
}

TEST(VariantsTest, AStudyWithoutVariantsHasNone) {
  const variants::VariantStudy study = variants::CompareVariants(
      std::vector{metrics::ArmData{"online", "rbs", {}}}, variants::Verdicts::kJudged);
  EXPECT_TRUE(study.variants.empty());
  EXPECT_EQ(variants::VariantText(study), "");
}

}  // namespace
}  // namespace ed3r
