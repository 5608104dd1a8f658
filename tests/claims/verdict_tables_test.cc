#include "studies/claims/verdict_tables.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>

#include "studies/paper/csv.h"
#include "studies/tables/layout.h"
#include "tests/claims/synthetic_run.h"

namespace ed3r {
namespace {

const ClaimStudy& Study() {
  static const ClaimStudy study = JudgeClaims(
      PaperClaims(), std::vector<ArmData>{MakeArm({"ed3r-75", 20, 0.02}), MakeArm({"ecd2r", 28, 0.05}),
                                          MakeArm({"rbs", 35, 0.2, 0, false})});
  return study;
}

std::string LineOf(const std::string& text, const std::string& id) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(id)) return line;
  return "";
}

TEST(VerdictTextTest, FitsTheTerminal) {
  std::istringstream lines(VerdictText(Study()));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(DisplayWidth(line), kTerminalWidth) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
}

TEST(VerdictTextTest, SaysWhatIsClaimedAndWhatCameOut) {
  const std::string text = VerdictText(Study());
  EXPECT_NE(LineOf(text, "C140").find("total energy: ed3r-75 < ecd2r, rbs"), std::string::npos);
  EXPECT_NE(LineOf(text, "C140").find("direction holds"), std::string::npos);
  EXPECT_NE(LineOf(text, "C104").find("21.44"), std::string::npos);
  EXPECT_NE(LineOf(text, "177 claims: "), "");
  EXPECT_NE(text.find("include the luck of training (5 networks"), std::string::npos);
}

TEST(VerdictTextTest, AnOppositeThatIsSignificantShowsItsOwnP) {
  const ClaimStudy study = JudgeClaims(
      PaperClaims(), std::vector<ArmData>{MakeArm({"ed3r-75", 45, 0.02}), MakeArm({"ecd2r", 28, 0.05}),
                                          MakeArm({"rbs", 35, 0.2, 0, false})});
  const std::string line = LineOf(VerdictText(study), "C140");
  EXPECT_NE(line.find("! "), std::string::npos) << line;
  EXPECT_NE(line.find("differs"), std::string::npos) << line;
  EXPECT_EQ(line.find("1.000"), std::string::npos) << line;
  const auto json = VerdictJson(study)[139];
  EXPECT_LT(json.at("p_against_holm"), 0.05);
  EXPECT_GT(json.at("p_holm"), 0.5);
}

TEST(VerdictTextTest, CountsWhatHoldsByConstructionApart) {
  const std::string summary = LineOf(VerdictText(Study()), "177 claims: ");
  EXPECT_GT(CountReproducedByConstruction(Study()), 0);
  EXPECT_NE(summary.find(fmt::format("{} by construction", CountReproducedByConstruction(Study()))),
            std::string::npos)
      << summary;
}

TEST(VerdictTextTest, DifferencesWithinTheLuckOfOneNetworkAreMarked) {
  const ClaimStudy study = JudgeClaims(PaperClaims(), std::vector<ArmData>{MakeArm({"ed3r-75", 35, 0, 0.3})});
  const std::string text = VerdictText(study);  // networks of 24.5 to 45.5 kJ; the paper's 21.44
  EXPECT_NE(LineOf(text, "C104").find("differs (luck)"), std::string::npos) << text;
  EXPECT_GT(CountWithinLuck(study), 0);
  EXPECT_NE(text.find(fmt::format("({} of them within", CountWithinLuck(study))), std::string::npos) << text;
}

TEST(VerdictTextTest, WhatIsNotThereTakesOneEntryPerReason) {
  const std::string text = VerdictText(Study());
  EXPECT_EQ(LineOf(text, "C027"), "");
  const std::string line =
      "Not measured, arms that are not in this run, or P85 groups too small for a verdict: ";
  EXPECT_NE(LineOf(text, line), "") << text;
  EXPECT_EQ(text.find("not in this run", text.find(line) + line.size()), std::string::npos);
}

TEST(VerdictTextTest, OneNetworkIsSaid) {
  SyntheticDesign single;
  single.networks = 1;
  const std::vector<ArmData> arms = {MakeArm({"ed3r-75", 20}, single)};
  EXPECT_NE(VerdictText(JudgeClaims(PaperClaims(), arms)).find("flew with one"), std::string::npos);
}

TEST(VerdictTextTest, NothingForOtherStudies) {
  const ClaimStudy other = JudgeClaims(PaperClaims(), std::vector<ArmData>{MakeArm({"heavy", 20})});
  EXPECT_EQ(VerdictText(other), "");
  EXPECT_TRUE(VerdictJson(other).empty());
  EXPECT_EQ(ParseCsv(VerdictCsv(other), "verdicts.csv").size(), 1u);
}

TEST(VerdictDataTest, JsonAndCsvAgree) {
  const auto json = VerdictJson(Study());
  const std::vector<CsvRow> rows = ParseCsv(VerdictCsv(Study()), "verdicts.csv");
  ASSERT_EQ(json.size(), PaperClaims().size());
  ASSERT_EQ(rows.size(), json.size() + 1);
  for (std::size_t i = 0; i < json.size(); ++i) {
    EXPECT_EQ(json[i].at("id"), rows[i + 1][0]);
    EXPECT_EQ(json[i].at("verdict"), rows[i + 1][14]);
    EXPECT_EQ(json[i].at("ours").is_null(), rows[i + 1][7].empty());
  }
  const auto& order = json[139];
  EXPECT_EQ(order.at("id"), "C140");
  EXPECT_EQ(order.at("by_network").at("counts").at("direction holds"), 5);
  EXPECT_EQ(order.at("by_network").at("ours").size(), 5u);
  EXPECT_EQ(rows[140][rows[0].size() - 5], "5");  // networks_direction_holds
  EXPECT_EQ(rows[0][rows[0].size() - 5], "networks_direction_holds");
}

TEST(ClaimInWordsTest, CutsWhatDoesNotFit) {
  for (const Claim& claim : PaperClaims()) {
    EXPECT_LE(DisplayWidth(ClaimInWords(claim, 30)), 30) << claim.id;
    EXPECT_FALSE(ClaimInWords(claim, 30).empty()) << claim.id;
  }
}

}  // namespace
}  // namespace ed3r
