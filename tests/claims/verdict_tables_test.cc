#include "studies/claims/verdict_tables.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "studies/tables/layout.h"
#include "tests/claims/synthetic_run.h"
#include "tests/studies/csv_rows.h"

namespace ed3r::claims {
namespace {

const ClaimStudy& Study() {
  static const ClaimStudy study =
      JudgeClaims(paper::PaperClaims(),
                  std::vector<metrics::ArmData>{MakeArm({"ed3r-75", 20, 0.02}), MakeArm({"ecd2r", 28, 0.05}),
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
    EXPECT_LE(tables::DisplayWidth(line), tables::kTerminalWidth) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
}

TEST(VerdictTextTest, SaysWhatIsClaimedAndWhatCameOut) {
  const std::string text = VerdictText(Study());
  EXPECT_NE(LineOf(text, "C140").find("total energy: ed3r-75 < ecd2r, rbs"), std::string::npos);
  EXPECT_NE(LineOf(text, "C140").find("direction holds"), std::string::npos);
  EXPECT_NE(LineOf(text, "C104").find("21.44"), std::string::npos);
  EXPECT_NE(LineOf(text, fmt::format("177 claims, {} of them different: ", CountDistinct(Study()))), "")
      << text;
  EXPECT_LT(CountDistinct(Study()), 177);
  EXPECT_NE(text.find("include the luck of training (5 networks"), std::string::npos);
}

const JudgedClaim& Claim(const ClaimStudy& study, std::string_view id) {
  return *std::find_if(study.claims.begin(), study.claims.end(),
                       [&](const JudgedClaim& judged) { return judged.claim.id == id; });
}

TEST(VerdictNotesTest, TellWhatNumbersOfTheStudyMean) {
  EXPECT_NE(VerdictRules().find("within 10 % of a size or 5 points"), std::string::npos) << VerdictRules();
  EXPECT_NE(CorrectionNote(Study()).find(fmt::format("for all {} different", Study().family)),
            std::string::npos);
  EXPECT_EQ(CorrectionNote({}), "");
  EXPECT_TRUE(ComparesP85(Claim(Study(), "C002")));
  EXPECT_FALSE(ComparesP85(Claim(Study(), "C122"))) << "of one group";
  const std::string note = P85ClaimNote(Study());
  EXPECT_NE(note.find(fmt::format("ED³R-75, P85 {:.1f} %, ECD²R, P85 {:.1f} %, RBS, P85 {:.1f} %",
                                  Claim(Study(), "C124").all.ours, Claim(Study(), "C130").all.ours,
                                  Claim(Study(), "C136").all.ours)),
            std::string::npos)
      << note;
  EXPECT_EQ(P85ClaimNote({}), "");
}

TEST(VerdictNotesTest, NetworksThatHaveTooFewMissionsAreNotCounted) {
  const auto [same, measured] = AgreeingNetworks(Claim(Study(), "C140"));
  EXPECT_EQ(measured, 5);
  EXPECT_GT(same, 0);
  EXPECT_EQ(AgreeingNetworks(Claim(Study(), "C145")), (std::pair<int, int>{}))
      << "P85 of one network's missions";
  EXPECT_EQ(AgreeingNetworks(Claim(Study(), "C116")), (std::pair<int, int>{})) << "RBS asks no network";
}

TEST(VerdictTextTest, AnOppositeThatIsSignificantShowsItsOwnP) {
  const ClaimStudy study =
      JudgeClaims(paper::PaperClaims(),
                  std::vector<metrics::ArmData>{MakeArm({"ed3r-75", 45, 0.02}), MakeArm({"ecd2r", 28, 0.05}),
                                                MakeArm({"rbs", 35, 0.2, 0, false})});
  const std::string line = LineOf(VerdictText(study), "C140");
  EXPECT_NE(line.find("! "), std::string::npos) << line;
  EXPECT_NE(line.find("differs"), std::string::npos) << line;
  EXPECT_EQ(line.find("1.000"), std::string::npos) << line;
  EXPECT_TRUE(PointsTheOtherWay(Claim(study, "C140")));
  EXPECT_FALSE(PointsTheOtherWay(Claim(Study(), "C140")));
  EXPECT_FALSE(PointsTheOtherWay(Claim(study, "C104"))) << "a number has no way";
  const auto json = VerdictJson(study)[139];
  EXPECT_LT(json.at("p_against_holm"), 0.05);
  EXPECT_GT(json.at("p_holm"), 0.5);
}

TEST(VerdictTextTest, CountsWhatHoldsByConstructionApart) {
  const std::string summary = VerdictText(Study());
  EXPECT_GT(CountReproducedByConstruction(Study()), 0);
  EXPECT_NE(summary.find(fmt::format("{} by construction", CountReproducedByConstruction(Study()))),
            std::string::npos)
      << summary;
}

TEST(VerdictTextTest, DifferencesThatTheLuckOfOneNetworkMayExplainAreMarked) {
  const auto line_of = [](double energy_kj, double luck) {
    SyntheticDesign many;
    many.missions = 4200;
    const ClaimStudy study = JudgeClaims(
        paper::PaperClaims(), std::vector<metrics::ArmData>{MakeArm({"ed3r-75", energy_kj, 0, luck}, many)});
    return LineOf(VerdictText(study), "C104");  // 21.44 kJ
  };
  // Networks within 4 % of 23.2 kJ: one more lies within +- 2.6 kJ, a band of less than four margins of 2.1 kJ.
  EXPECT_NE(line_of(23.2, 0.04).find("differs (luck)"), std::string::npos) << line_of(23.2, 0.04);
  // Within 30 % of 40 kJ: a band of 60 kJ would hold almost anything.
  EXPECT_NE(line_of(40, 0.3).find("differs (luck?)"), std::string::npos) << line_of(40, 0.3);
  EXPECT_EQ(line_of(40, 0.01).find("(luck"), std::string::npos) << line_of(40, 0.01);
}

// Every network has the same chance of a false alarm, and some raise none in 28 missions by it: that is no luck of theirs.
TEST(VerdictTextTest, NetworksWithoutAFailureAreNotTakenForPerfectOnes) {
  const SyntheticDesign twenty{.missions = 560, .networks = 20, .places = 28};
  const ClaimStudy study = JudgeClaims(
      paper::PaperClaims(), std::vector<metrics::ArmData>{MakeArm({"ed3r-75", 20, 0.125}, twenty)});
  const std::string line = LineOf(VerdictText(study), "C024");  // 1.41 %
  EXPECT_NE(line.find("differs"), std::string::npos) << line;
  EXPECT_EQ(line.find("(luck"), std::string::npos) << line;
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
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20}, single)};
  EXPECT_NE(VerdictText(JudgeClaims(paper::PaperClaims(), arms)).find("flew with one"), std::string::npos);
}

TEST(VerdictTextTest, NothingForOtherStudies) {
  const ClaimStudy other =
      JudgeClaims(paper::PaperClaims(), std::vector<metrics::ArmData>{MakeArm({"heavy", 20})});
  EXPECT_EQ(VerdictText(other), "");
  EXPECT_TRUE(VerdictJson(other).empty());
  EXPECT_EQ(CsvRows(VerdictCsv(other)).size(), 1u);
}

TEST(VerdictDataTest, JsonAndCsvAgree) {
  const auto json = VerdictJson(Study());
  const std::vector<CsvRow> rows = CsvRows(VerdictCsv(Study()));
  ASSERT_EQ(json.size(), paper::PaperClaims().size());
  ASSERT_EQ(rows.size(), json.size() + 1);
  for (std::size_t i = 0; i < json.size(); ++i) {
    EXPECT_EQ(json[i].at("id"), rows[i + 1][0]);
    EXPECT_EQ(json[i].at("verdict"), rows[i + 1][17]);
    EXPECT_EQ(json[i].at("ours").is_null(), rows[i + 1][7].empty());
  }
  const auto& order = json[139];
  EXPECT_EQ(order.at("id"), "C140");
  EXPECT_EQ(order.at("by_network").at("counts").at("direction holds"), 5);
  EXPECT_EQ(order.at("by_network").at("ours").size(), 5u);
  EXPECT_EQ(rows[140][rows[0].size() - 6], "5");  // networks_direction_holds
  EXPECT_EQ(rows[0][rows[0].size() - 6], "networks_direction_holds");
}

TEST(ClaimInWordsTest, CutsWhatDoesNotFit) {
  for (const paper::Claim& claim : paper::PaperClaims()) {
    EXPECT_LE(tables::DisplayWidth(ClaimInWords(claim, 30)), 30) << claim.id;
    EXPECT_FALSE(ClaimInWords(claim, 30).empty()) << claim.id;
  }
}

}  // namespace
}  // namespace ed3r::claims
