// The arms of a stage beside each other, paired by scenario.
#include "studies/variants/arm_differences.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "studies/report/html.h"
#include "studies/report/report.h"
#include "studies/statistics/intervals.h"

namespace ed3r {
namespace {

mission::MissionRecord MissionOf(std::int64_t scenario, double energy_kj) {
  mission::MissionRecord mission;
  mission.scenario = scenario;
  mission.site = scenario % 3;
  mission.start_x_m = 10.0 * static_cast<double>(scenario);
  mission.timesteps = mission.full_local = 1;
  mission.duration_s = 60;
  mission.total_j = mission.movement_j = 1000 * energy_kj;
  mission.outcome = static_cast<std::int64_t>(mission::Outcome::kSuccess);
  return mission;
}

// Scenario i costs 10 + i kJ and what is added for it.
metrics::ArmData ArmOf(const std::string& stage, const std::string& name, const std::vector<double>& added) {
  metrics::ArmData arm{stage, name, {}};
  for (std::size_t i = 0; i < added.size(); ++i)
    arm.missions.push_back(MissionOf(static_cast<std::int64_t>(i), 10 + static_cast<double>(i) + added[i]));
  return arm;
}

const std::vector<double> kNothing(6, 0.0), kLess = {-3, -4, -5, -3, -4, -5}, kNoise = {1, -1, 1, -1, 2, -1};

std::vector<metrics::ArmData> Stage() {
  return {ArmOf("online", "mine", kLess), ArmOf("online", "rbs", kNothing), ArmOf("online", "other", kNoise)};
}

const variants::ArmDifference& EnergyOf(const std::vector<variants::ArmDifference>& differences,
                                        const std::string& arm) {
  for (const variants::ArmDifference& d : differences)
    if (d.arm == arm && d.metric == "total_energy_kj") return d;
  throw std::out_of_range(arm);
}

TEST(ArmDifferencesTest, ALongNameDoesNotShiftItsRow) {
  const std::string name = "random-offload,path_loss_exponent=3.2";
  const std::string text = variants::ArmDifferenceText(
      variants::CompareArms(std::vector{ArmOf("online", "rbs", kNothing), ArmOf("online", name, kLess)}));
  std::istringstream lines(text);
  std::string line, heading;
  while (std::getline(lines, line) && !line.starts_with(name))
    if (line.starts_with("arm ")) heading = line;
  EXPECT_EQ(heading.find("pairs") + 4, line.find(" 6 ") + 1) << text;
}

TEST(ArmDifferencesTest, EveryArmIsComparedWithTheRandomWalk) {
  const std::vector<variants::ArmDifference> differences = variants::CompareArms(Stage());
  ASSERT_EQ(differences.size(), 6u);
  const variants::ArmDifference& mine = EnergyOf(differences, "mine");
  EXPECT_EQ(mine.minus, "rbs");
  EXPECT_EQ(mine.pairs, 6);
  EXPECT_NEAR(mine.base, 12.5, 1e-12);
  EXPECT_NEAR(mine.difference, -4.0, 1e-12);
  // The six differences have a standard deviation of sqrt(0.8): t = -4 / sqrt(0.8 / 6) with 5 degrees.
  const double t = -4 / std::sqrt(0.8 / 6);
  EXPECT_NEAR(mine.hi, -4 + 2.5705818356 * std::sqrt(0.8 / 6), 1e-9);
  EXPECT_NEAR(mine.p, statistics::StudentP(t, 5), 1e-12);
  EXPECT_TRUE(mine.Certain());
  EXPECT_FALSE(EnergyOf(differences, "other").Certain());
}

TEST(ArmDifferencesTest, PIsCorrectedForAllThatIsTold) {
  const std::vector<variants::ArmDifference> differences = variants::CompareArms(Stage());
  // Of six questions, four are about metrics that do not differ at all (p = 1).
  const variants::ArmDifference &mine = EnergyOf(differences, "mine"),
                                &other = EnergyOf(differences, "other");
  EXPECT_DOUBLE_EQ(mine.p_holm, 6 * mine.p);
  EXPECT_DOUBLE_EQ(other.p_holm, 1.0);
  for (const variants::ArmDifference& d : differences)
    if (d.metric != "total_energy_kj") {
      EXPECT_DOUBLE_EQ(d.p, 1.0) << d.metric;
    }
}

TEST(ArmDifferencesTest, WithoutTheRandomWalkTheFirstArmIsTheMeasure) {
  std::vector<metrics::ArmData> arms = {ArmOf("a", "first", kNothing), ArmOf("a", "second", kLess),
                                        ArmOf("b", "alone", kNothing)};
  const std::vector<variants::ArmDifference> differences = variants::CompareArms(arms);
  ASSERT_EQ(differences.size(), 3u) << "the stage with one arm has nothing to compare";
  EXPECT_EQ(differences[0].minus, "first");
  arms[0].missions.clear();
  EXPECT_TRUE(variants::CompareArms(arms).empty()) << "nor has an arm whose partner has not flown";
}

TEST(ArmDifferencesTest, OtherScenariosAreNotPaired) {
  std::vector<metrics::ArmData> arms = Stage();
  for (mission::MissionRecord& mission : arms[0].missions) mission.start_x_m += 1;  // another world
  const std::vector<variants::ArmDifference> differences = variants::CompareArms(arms);
  ASSERT_EQ(differences.size(), 3u);
  EXPECT_EQ(differences[0].arm, "other");
  arms[1].world = "one", arms[2].world = "another";
  const std::string text = report::ReportText(report::MakeReport({"own", arms}, {}));
  EXPECT_NE(text.find("not compared with 'rbs' are mine, whose scenarios"), std::string::npos) << text;
  EXPECT_NE(text.find("not the world of 'rbs'; a place of one number may lie"), std::string::npos) << text;
}

TEST(ArmDifferencesTest, FewPairsSayWhatTheyCan) {
  const std::vector<variants::ArmDifference> one =
      variants::CompareArms(std::vector{ArmOf("a", "x", {0}), ArmOf("a", "y", {-1})});
  ASSERT_EQ(one.size(), 3u);
  EXPECT_NEAR(one[0].difference, -1, 1e-12);
  EXPECT_TRUE(std::isnan(one[0].lo) && std::isnan(one[0].p) && std::isnan(one[0].p_holm));
  EXPECT_FALSE(one[0].Certain());
  // Alike in every pair: the spread is unknown, the sign test is not.
  const std::vector<double> apart(4, -8.0);
  const std::vector<variants::ArmDifference> alike = variants::CompareArms(
      std::vector{ArmOf("a", "x", std::vector<double>(4, 0.0)), ArmOf("a", "y", apart)});
  EXPECT_DOUBLE_EQ(alike[0].p, 0.125);
  EXPECT_FALSE(alike[0].Certain());
}

TEST(ArmDifferencesTest, ReportsOfOwnArmsTellThem) {
  const report::Report report = report::MakeReport({"own", Stage()}, {});
  ASSERT_EQ(report.differences.size(), 6u);
  const std::string text = report::ReportText(report);
  EXPECT_NE(text.find("arms minus 'rbs', paired by scenario"), std::string::npos) << text;
  EXPECT_NE(text.find("-4.0* [-4.9, -3.1] p <0.001"), std::string::npos) << text;
  const nlohmann::ordered_json json = report::ReportJson(report);
  EXPECT_EQ(json["differences"].size(), 6u);
  EXPECT_EQ(json["differences"][0]["arm"], "mine");
  EXPECT_NEAR(json["differences"][0]["difference"].get<double>(), -4.0, 1e-12);
  EXPECT_EQ(json["differences"][0]["certain"], true);
  EXPECT_EQ(variants::ArmDifferenceCsv(report.differences).substr(0, 84),
            "stage,arm,minus,metric,base,difference,lo,hi,p,p_holm,pairs,base_networks,networks\no");
}

TEST(ArmDifferencesTest, PagesTellThem) {
  std::vector<metrics::ArmData> arms = Stage();
  arms[0].name = "<mine>";
  const report::Report report = report::MakeReport({"own", arms}, {});
  const report::Provenance provenance;
  const nlohmann::ordered_json figures = nlohmann::ordered_json::array();
  const std::string page = report::ReportContent({.report = report,
                                                  .provenance = provenance,
                                                  .figures = figures,
                                                  .figures_note = "",
                                                  .report_command = ""});
  EXPECT_NE(page.find("<tr><th>&lt;mine&gt;</th><td>rbs</td><td>energy, kJ</td><td><b>-4.00</b><i>-4.94 to "
                      "-3.06</i></td><td>&lt;0.001</td><td>6</td></tr>"),
            std::string::npos)
      << page;
}

TEST(ArmDifferencesTest, VerdictsTellThoseOfThePaper) {
  const std::vector<metrics::ArmData> paper = {ArmOf("online", "ed3r-75", kLess),
                                               ArmOf("online", "rbs", kNothing)};
  EXPECT_TRUE(report::MakeReport({"paper", paper}, {}).differences.empty());
  std::vector<metrics::ArmData> with_own = paper;
  with_own.push_back(ArmOf("online", "mine", kNoise));
  EXPECT_EQ(report::MakeReport({"own", with_own}, {}).differences.size(), 6u);
}

}  // namespace
}  // namespace ed3r
