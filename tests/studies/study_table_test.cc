#include "studies/tables/study_table.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "studies/tables/names.h"
#include "tests/studies/five_missions.h"

namespace ed3r {
namespace {

metrics::ArmMetrics Metrics(const std::string& name, const std::string& stage = "online") {
  metrics::ArmData arm = FiveMissions();
  arm.stage = stage, arm.name = name;
  return metrics::ComputeMetrics(arm);
}

const tables::StudyTable* Find(const std::vector<tables::StudyTable>& tables, const std::string& id) {
  for (const tables::StudyTable& table : tables)
    if (table.id == id) return &table;
  return nullptr;
}

std::vector<std::string> ArmNames(const tables::StudyTable& table) {
  std::vector<std::string> names;
  for (const metrics::ArmMetrics& arm : table.arms) names.push_back(arm.name);
  return names;
}

tables::StudyTable OneCell() {
  return {.id = "one",
          .title = "A & B",
          .note = {},
          .arms = {Metrics("ed3r-75")},
          .labels = {"ED³R-75"},
          .metrics = {metrics::MetricIndex("msr_pct"), metrics::MetricIndex("duration_max_min")}};
}

TEST(StudyTableTest, ARunOfThePaperHasItsTables) {
  const std::vector<metrics::ArmMetrics> arms = {
      Metrics("warmup", "warmup"), Metrics("ed3r-65"), Metrics("ed3r-75"),
      Metrics("ed3r-85"),          Metrics("ecd2r"),   Metrics("rbs")};
  const std::vector<metrics::ArmMetrics> p85 = {Metrics("ed3r-p85"), Metrics("rbs-p85"),
                                                Metrics("ed3r-65-p85")};
  const auto tables = tables::MakeStudyTables(arms, p85);
  ASSERT_EQ(tables.size(), 3u);
  EXPECT_EQ(ArmNames(tables[0]).size(), 6u);
  EXPECT_EQ(ArmNames(*Find(tables, "thresholds")),
            (std::vector<std::string>{"ed3r-65", "ed3r-75", "ed3r-85"}));
  EXPECT_EQ(ArmNames(*Find(tables, "baselines")),
            (std::vector<std::string>{"ed3r-75", "ecd2r", "rbs", "ed3r-p85", "rbs-p85"}));
  for (const tables::StudyTable& table : tables)
    EXPECT_EQ(table.note.empty(), table.id != "baselines") << table.id;
  EXPECT_EQ(Find(tables, "ablations"), nullptr);  // ED3R alone compares with nothing
}

TEST(StudyTableTest, ArmsOfDifferentStagesAreNotCompared) {
  EXPECT_EQ(tables::MakeStudyTables(std::vector{Metrics("ed3r-75", "one"), Metrics("rbs", "two")}, {}).size(),
            1u);
}

TEST(StudyTableTest, ArmsWithoutMissionsAreLeftOut) {
  const metrics::ArmData none{
      .stage = "online", .name = "ed3r-65", .missions = {}, .failed = 0, .missing = 5};
  EXPECT_TRUE(tables::MakeStudyTables(std::vector{metrics::ComputeMetrics(none)}, {}).empty());
  const auto tables =
      tables::MakeStudyTables(std::vector{metrics::ComputeMetrics(none), Metrics("mine")}, {});
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(ArmNames(tables[0]), std::vector<std::string>{"mine"});
}

TEST(StudyTableTest, MarkdownHasARowPerArmAndEqualCells) {
  const std::string text = tables::MarkdownTable(OneCell(), paper::PaperClaims());
  EXPECT_EQ(text,
            "**A & B.** 95 % intervals in parentheses, the paper's values in brackets.\n\n"
            "| arm | MSR, % | longest mission, min |\n|---|---|---|\n"
            "| ED³R-75 | 60.00 (23.07–88.24) [97.18] | 18.00 [~18] |\n");
}

TEST(StudyTableTest, MetricsCanGoDown) {
  tables::StudyTable table = OneCell();
  table.arms_down = false;
  const std::string text = tables::MarkdownTable(table, paper::PaperClaims());
  EXPECT_NE(text.find("| metric | ED³R-75 |\n|---|---|\n| MSR, % | 60.00 (23.07–88.24) [97.18] |"),
            std::string::npos)
      << text;
}

TEST(StudyTableTest, LatexPutsThePaperUnderOurs) {
  const std::string text = tables::LatexTable(OneCell(), paper::PaperClaims());
  EXPECT_NE(text.find("\\caption{A \\& B."), std::string::npos) << text;
  EXPECT_NE(text.find("\\begin{tabular}{lrr}"), std::string::npos) << text;
  EXPECT_NE(text.find("ED\\textsuperscript{3}R-75 & 60.00 {\\scriptsize 23.07--88.24} & 18.00 \\\\\n"
                      "    \\quad\\textit{paper} & \\textit{97.18} & \\textit{\\textasciitilde{}18} \\\\\n"),
            std::string::npos)
      << text;
}

TEST(StudyTableTest, LatexHasNoPaperLineWhereThePaperSaysNothing) {
  tables::StudyTable table = OneCell();
  table.arms = {Metrics("mine")}, table.labels = {"mine"};
  EXPECT_EQ(tables::LatexTable(table, paper::PaperClaims()).find("textit{paper}"), std::string::npos);
}

TEST(StudyTableTest, LatexEscapesWhatItMust) {
  EXPECT_EQ(tables::LatexText("a_b & 5 % of $x^2 #{~}\\"),
            "a\\_b \\& 5 \\% of \\$x\\textasciicircum{}2 \\#\\{\\textasciitilde{}\\}\\textbackslash{}");
  EXPECT_EQ(tables::LatexText("ECD²R η≥1–2"), "ECD\\textsuperscript{2}R $\\eta$$\\geq$1--2");
}

TEST(StudyTableTest, MarkdownEscapesWhatWouldBreakACell) {
  EXPECT_EQ(tables::MarkdownText("a|b_c*d`e<f\ng"), "a\\|b\\_c\\*d\\`e&lt;f g");
}

TEST(StudyTableTest, CsvAndJsonHaveFullPrecision) {
  tables::StudyTable table = OneCell();
  table.metrics = {metrics::MetricIndex("total_energy_kj"), metrics::MetricIndex("duration_max_min")};
  const std::string csv = tables::CsvTable(table, paper::PaperClaims());
  EXPECT_TRUE(
      csv.starts_with("stage,arm,missions,metric,unit,value,lo,hi,n,paper\n"
                      "online,ed3r-75,5,total_energy_kj,kJ,48,"))
      << csv;
  EXPECT_NE(csv.find("online,ed3r-75,5,duration_max_min,min,18,,,5,18\n"), std::string::npos) << csv;
  const auto arm = tables::JsonTable(table, paper::PaperClaims()).at("arms").at(0);
  EXPECT_EQ(arm.at("label"), "ED³R-75");
  EXPECT_EQ(arm.at("total_energy_kj").at("mean"), 48);
  EXPECT_EQ(arm.at("total_energy_kj").at("paper"), 21.44);
  EXPECT_TRUE(arm.at("duration_max_min").at("lo").is_null());
}

TEST(ArmLabelTest, KnowsThePapersArmsAndKeepsOthers) {
  EXPECT_EQ(tables::ArmLabel("ed3r-75"), "ED³R-75");
  EXPECT_EQ(tables::ArmLabel("ed3r-p85"), "ED³R-75, P85");
  EXPECT_EQ(tables::ArmLabel("rbs-p85"), "RBS, P85");
  EXPECT_EQ(tables::ArmLabel("robot.mass_kg=2.1"), "robot.mass_kg=2.1");
  EXPECT_EQ(tables::ArmLabel("-p85"), "-p85");
}

}  // namespace
}  // namespace ed3r
