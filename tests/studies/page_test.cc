// The data of the interactive page: filters, counts, sentences.
#include <gtest/gtest.h>

#include "engine/agents/strategy.h"
#include "studies/report/page_answer.h"
#include "studies/report/page_arms.h"
#include "studies/report/page_slices.h"
#include "studies/report/report.h"
#include "studies/report/web_page.h"
#include "tests/studies/five_missions.h"

namespace ed3r {
namespace {

// Sites 3 (missions 1 and 3, known) and 8.
metrics::ArmData TwoSites() {
  metrics::ArmData arm = FiveMissions();
  for (const std::size_t i : {0u, 2u}) arm.missions[i].site = 3;
  for (const std::size_t i : {1u, 3u, 4u}) arm.missions[i].site = 8;
  return arm;
}

TEST(PageSlicesTest, EveryFilterIsComputedByTheTablesCode) {
  const std::vector<metrics::ArmData> arms = {TwoSites()};
  const std::vector<metrics::ArmMetrics> metrics = {metrics::ComputeMetrics(arms[0])};
  const auto slices = report::SlicesJson(arms, metrics);
  EXPECT_EQ(slices.size(), 5u * 4u);  // all, known, unseen, 3, 8; every outcome and each
  const auto value = [&](const char* slice, const char* metric) {
    return slices.at(slice).at(0).at(1 + 3 * metrics::MetricIndex(metric));
  };
  EXPECT_EQ(slices.at("all|all").at(0).at(0), 5);
  EXPECT_EQ(value("all|all", "total_energy_kj"), metrics[0]["total_energy_kj"].value);
  EXPECT_EQ(slices.at("3|all").at(0).at(0), 2);
  EXPECT_EQ(value("3|all", "msr_pct"), 50);
  EXPECT_EQ(value("known|all", "total_energy_kj"), 9.8);
  EXPECT_EQ(value("8|2", "total_energy_kj"), 139.4);
  EXPECT_EQ(value("all|1", "fp_pct"), 100);
  EXPECT_TRUE(slices.at("3|2").at(0).is_null());
  EXPECT_TRUE(value("3|all", "lf_accuracy_pct").is_null()) << "relative to the worst of the whole arm";
  EXPECT_FALSE(value("all|all", "lf_accuracy_pct").is_null());
}

TEST(PageSlicesTest, ManySitesComeWithoutOutcomes) {
  metrics::ArmData arm = FiveMissions();
  const mission::MissionRecord mission = arm.missions[0];
  arm.missions.assign(report::kMostSites + 1, mission);
  for (std::size_t i = 0; i < arm.missions.size(); ++i) arm.missions[i].site = static_cast<std::int64_t>(i);
  const auto slices =
      report::SlicesJson({&arm, 1}, std::vector<metrics::ArmMetrics>{metrics::ComputeMetrics(arm)});
  EXPECT_TRUE(slices.contains("40|all"));
  EXPECT_FALSE(slices.contains("40|0"));
  EXPECT_TRUE(slices.contains("all|0"));
}

TEST(PageSlicesTest, HistogramsCountEveryMissionThatHasTheValue) {
  const std::vector<metrics::ArmData> arms = {TwoSites()};
  const auto histograms = report::HistogramsJson(arms);
  std::vector<int> missions(histograms.at("scales").size());
  for (const auto& cell : histograms.at("cells"))
    for (std::size_t i = 5; i < cell.size(); ++i) missions[cell[3].get<std::size_t>()] += cell[i].get<int>();
  EXPECT_EQ(missions, (std::vector<int>{5, 5, 4})) << "the one without a reliable look has no confidence";
  const auto& energy = histograms.at("scales").at(0);
  EXPECT_EQ(energy.at("from"), 0);
  EXPECT_NEAR(energy.at("step").get<double>() * energy.at("bins").get<int>(), 140, 1e-9);
}

TEST(PageSlicesTest, PointsAreThinnedByNumber) {
  metrics::ArmData arm = FiveMissions();
  std::vector<std::vector<int>> numbers = {{0, 1, 2, 2 * report::kMostPoints, 2 * report::kMostPoints + 1}};
  const auto points = report::PointsJson({&arm, 1}, numbers).at(0);
  EXPECT_EQ(points.at("every"), 3);
  EXPECT_EQ(points.at("number"), (std::vector<int>{0, 2 * report::kMostPoints}));
  EXPECT_EQ(points.at("energy_kj").at(0), 7.6);
  EXPECT_EQ(points.at("energy_kj").at(1), 139.4);
}

TEST(PageSlicesTest, FailuresAreListedByCauseWithTheirNumbers) {
  metrics::ArmData arm = FiveMissions();
  const std::vector<std::vector<int>> numbers = {{0, 1, 5, 7, 9}};
  const auto groups = report::FailuresJson({&arm, 1}, numbers);
  ASSERT_EQ(groups.size(), 2u);
  int found = 0;
  for (const auto& group : groups) {
    EXPECT_EQ(group.at("count"), 1);
    if (group.at("outcome") == 1) found += group.at("missions").at(0).at(0) == 5;
    if (group.at("outcome") == 2) found += group.at("missions").at(0).at(0) == 7;
  }
  EXPECT_EQ(found, 2);
}

// More failures than are listed, most at one site; those at the other come after the list is full.
TEST(PageSlicesTest, FailuresAreCountedAtEachSiteThoughFewAreListed) {
  constexpr int kAtThree = 70, kAtEight = 8;
  metrics::ArmData arm{.stage = "online", .name = "rbs", .missions = {}};
  std::vector<std::vector<int>> numbers(1);
  for (int i = 0; i < kAtThree + kAtEight; ++i) {
    mission::MissionRecord& m =
        arm.missions.emplace_back(FlownMission(mission::Outcome::kFalsePositive, 0, 7, 0, 60));
    Detect(m, 2, 1.6, 0);
    m.site = i < kAtThree ? 3 : 8;
    m.site_known = i < kAtThree;
    numbers[0].push_back(i);
  }
  const auto groups = report::FailuresJson({&arm, 1}, numbers);
  ASSERT_EQ(groups.size(), 1u);
  const auto& group = groups[0];
  EXPECT_EQ(group.at("count"), kAtThree + kAtEight);
  EXPECT_EQ(group.at("known"), kAtThree);
  EXPECT_EQ(group.at("sites").at("3"), kAtThree);
  EXPECT_EQ(group.at("sites").at("8"), kAtEight);
  EXPECT_EQ(group.at("sites").size(), 2u);
  const auto& missions = group.at("missions");
  ASSERT_EQ(missions.size(), report::kMostFailuresListed + report::kFailuresListedPerSite);
  EXPECT_EQ(missions.at(report::kMostFailuresListed).at(0), kAtThree);
  EXPECT_EQ(missions.at(report::kMostFailuresListed).at(1), 8);
  EXPECT_EQ(missions.at(0).at(4), 7) << "timesteps";
  EXPECT_EQ(missions.at(0).at(5), 2) << "reliable ones";
}

// Nine arms of 10,000 missions at 14 sites: what grows with missions is bounded.
TEST(PageSlicesTest, TheDataStaySmallForManyMissions) {
  constexpr int kMissions = 10000, kArms = 9, kSites = 14;
  const metrics::ArmData five = FiveMissions();
  metrics::ArmData arm{.stage = "online", .name = "rbs", .missions = {}};
  std::vector<int> numbers;
  for (int i = 0; i < kMissions; ++i) {
    mission::MissionRecord mission = five.missions[static_cast<std::size_t>(i) % 5];
    mission.site = i % kSites;
    mission.site_known = mission.site < 6;
    mission.duration_s += i % 971;
    arm.missions.push_back(mission);
    numbers.push_back(i);
  }
  const std::vector<metrics::ArmData> arms(kArms, arm);
  const std::vector<metrics::ArmMetrics> metrics(kArms, metrics::ComputeMetrics(arm));
  const std::vector<std::vector<int>> all_numbers(kArms, numbers);
  const std::size_t bytes = report::SlicesJson(arms, metrics).dump().size() +
                            report::HistogramsJson(arms).dump().size() +
                            report::PointsJson(arms, all_numbers).dump().size() +
                            report::FailuresJson(arms, all_numbers).dump().size();
  EXPECT_LT(bytes, 2'500'000u);
}

std::vector<std::string> Answer(std::vector<metrics::ArmData> arms, std::vector<bool> warmups) {
  return report::AnswerSentences(report::MakeReport({.name = "x", .arms = arms}, {}), warmups, arms);
}

// Twelve missions in scenarios of their own, each `energy_kj` and up to 1.1 kJ more; the first `found` succeed.
metrics::ArmData TwelveMissions(const char* name, double energy_kj, int found) {
  metrics::ArmData arm{.stage = "online", .name = name, .missions = {}};
  for (int i = 0; i < 12; ++i) {
    mission::MissionRecord& m = arm.missions.emplace_back(
        FlownMission(i < found ? mission::Outcome::kSuccess : mission::Outcome::kFalsePositive, 0, 4, 0, 60));
    m.scenario = i;
    SpendEnergy(m, 1000 * energy_kj + 100 * (i % 5) * (i % 3), 0, 0, 0);
  }
  return arm;
}

TEST(PageAnswerTest, TellsTheStudiedArmBesideItsRival) {
  const auto sentences =
      Answer({TwelveMissions("mine", 10, 9), TwelveMissions("rbs", 20, 8)}, {false, false});
  ASSERT_GE(sentences.size(), 2u);
  EXPECT_TRUE(sentences[0].starts_with("mine finds the fire in 75.0 % (")) << sentences[0];
  EXPECT_TRUE(sentences[1].starts_with("RBS finds the fire in 66.7 % (")) << sentences[1];
  EXPECT_NE(sentences[1].find("in the same scenarios mine has 8.3 points more success ("), std::string::npos)
      << sentences[1];
  EXPECT_NE(
      sentences[1].find(", not significant) and 10.0 kJ less energy (10.0 to 10.0; p < 0.001, significant)"),
      std::string::npos)
      << sentences[1];
  EXPECT_NE(sentences[1].find("correction for all 3 comparisons of arms"), std::string::npos) << sentences[1];
}

// The rival is of the studied arm's stage, though another stage has one of its name before.
TEST(PageAnswerTest, ComparesWithinAStage) {
  metrics::ArmData other = TwelveMissions("rbs", 3, 2);
  other.stage = "small";
  const auto sentences =
      Answer({other, TwelveMissions("rbs", 20, 8), TwelveMissions("ed3r-75", 10, 9)}, {false, false, false});
  ASSERT_GE(sentences.size(), 2u);
  for (const std::string& sentence : sentences)
    EXPECT_EQ(sentence.find("lowest mean energy"), std::string::npos)
        << "two arms of the stage: " << sentence;
  EXPECT_TRUE(sentences[1].starts_with("RBS finds the fire in 66.7 % (")) << sentences[1];
}

// Alone the interval is clear of 0; six arms more, each compared in three metrics, raise the corrected p.
TEST(PageAnswerTest, SaysWhyAnIntervalClearOfZeroIsNotSignificant) {
  std::vector<metrics::ArmData> arms = {TwelveMissions("mine", 10, 12), TwelveMissions("rbs", 20, 6)};
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) arms.push_back(TwelveMissions(name, 20, 6));
  const std::string told = Answer(arms, std::vector<bool>(arms.size(), false)).at(1);
  EXPECT_NE(told.find("50.0 points more success ("), std::string::npos) << told;
  EXPECT_NE(told.find("; clear of 0 taken alone, but not significant among all "), std::string::npos) << told;
  EXPECT_EQ(told.find(", not significant"), std::string::npos) << told;
}

TEST(PageAnswerTest, NamesTheArmOfTheBestMeans) {
  const std::vector<metrics::ArmData> arms = {TwelveMissions("ed3r-75", 10, 9), TwelveMissions("mine", 5, 10),
                                              TwelveMissions("rbs", 20, 8)};
  const std::string best = Answer(arms, {false, false, false}).at(2);
  EXPECT_TRUE(
      best.starts_with("mine has the lowest mean energy (5.2 kJ) and the highest mean success (83.3 %)"))
      << best;
  EXPECT_NE(
      best.find("; beside ED³R-75 that is 5.0 kJ less energy (5.0 to 5.0; p < 0.001, significant) and 8.3 "
                "points more success ("),
      std::string::npos)
      << best;
  const std::string own =
      Answer({arms[0], TwelveMissions("other", 12, 7), arms[2]}, {false, false, false}).at(2);
  EXPECT_TRUE(own.starts_with("ED³R-75 has the lowest mean energy")) << own;
  EXPECT_TRUE(own.ends_with(" of all arms.")) << own;
}

TEST(PageAnswerTest, SaysNothingOfArmsInOtherScenarios) {
  metrics::ArmData rbs = TwelveMissions("rbs", 20, 8);
  for (mission::MissionRecord& m : rbs.missions) m.scenario += 100;
  const auto sentences = Answer({TwelveMissions("mine", 10, 9), rbs}, {false, false});
  EXPECT_TRUE(sentences.at(1).ends_with("no scenarios in common, so nothing is said of their difference."))
      << sentences.at(1);
}

TEST(PageAnswerTest, WarmUpsAreNoAnswer) {
  EXPECT_TRUE(Answer({FiveMissions()}, {true}).empty());
  EXPECT_TRUE(Answer({}, {}).empty());
}

TEST(PageArmsTest, EveryStrategyIsTold) {
  for (const agents::Strategy& strategy : agents::Strategies())
    EXPECT_FALSE(report::AboutStrategy(strategy.name).empty()) << strategy.name;
  EXPECT_TRUE(report::AboutStrategy("mine").empty());
}

TEST(WebPageTest, NoTextEndsTheElementThatHoldsIt) {
  const nlohmann::ordered_json data = {{"name", "</script><script>x"}};
  const std::string page = report::SelfContainedPage("<b>&", {"program", "style"}, data, "plain");
  EXPECT_NE(page.find("<title>&lt;b&gt;&amp;</title>"), std::string::npos);
  EXPECT_NE(page.find("\\u003c/script>\\u003cscript>x"), std::string::npos);
  EXPECT_NE(page.find("<noscript>plain</noscript>"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

}  // namespace
}  // namespace ed3r
