#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "studies/tables/data_files.h"
#include "studies/tables/layout.h"
#include "studies/tables/paper_cell.h"
#include "studies/tables/result_table.h"
#include "tests/studies/csv_rows.h"
#include "tests/studies/five_missions.h"

namespace ed3r {
namespace {

metrics::ArmMetrics Named(const std::string& stage, const std::string& name) {
  metrics::ArmMetrics arm = metrics::ComputeMetrics(FiveMissions());
  arm.stage = stage, arm.name = name;
  return arm;
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string LineWith(const std::string& text, std::string_view part) {
  for (const std::string& line : Lines(text))
    if (line.find(part) != std::string::npos) return line;
  return "";
}

TEST(LayoutTest, WidthsCountCharacters) {
  EXPECT_EQ(tables::DisplayWidth("ED³R ± ✓†"), 9);
  EXPECT_EQ(tables::Pad("–", 3, tables::Align::kRight), "  –");
  EXPECT_EQ(tables::Pad("ab", 5, tables::Align::kCentre), " ab  ");
  EXPECT_EQ(tables::Pad("longer", 3, tables::Align::kLeft), "longer");
  EXPECT_EQ(tables::DisplayWidth(tables::Rule(7)), 7);
}

TEST(LayoutTest, WrapIndents) {
  EXPECT_EQ(tables::Wrap("one two three", "* ", 9), "* one two\n  three\n");
  EXPECT_EQ(tables::Wrap("unbreakable", "", 4), "unbreakable\n");
}

TEST(LayoutTest, NumbersTakeFiveCharacters) {
  EXPECT_EQ(tables::FormatValue(21.4361, 2), "21.44");
  EXPECT_EQ(tables::FormatValue(139.86, 2), "139.9");
  EXPECT_EQ(tables::FormatValue(99.999, 2), "100.0");
  EXPECT_EQ(tables::FormatValue(123456.7, 2), "123457");
  EXPECT_EQ(tables::FormatValue(std::nan(""), 2), "–");
}

metrics::MetricValue Set(metrics::ArmMetrics& arm, const char* metric, double value, double lo, double hi) {
  return arm.values[metrics::MetricIndex(metric)] = {value, lo, hi, 850};
}

TEST(PaperCellTest, MarksWhatItSays) {
  metrics::ArmMetrics arm = Named("online", "ed3r-75");
  const auto text = [&](const char* metric) {
    return tables::MakePaperCell(paper::PaperClaims(), arm, metrics::MetricIndex(metric)).text;
  };
  Set(arm, "total_energy_kj", 22, 21, 23);
  EXPECT_EQ(text("total_energy_kj"), "21.44✓†");
  Set(arm, "total_energy_kj", 23, 22, 24);
  EXPECT_EQ(text("total_energy_kj"), "21.44†");
  Set(arm, "msr_pct", 97, 97.183, 98);  // 97.18 may stand for anything up to 97.185
  EXPECT_EQ(text("msr_pct"), "97.18✓");
  Set(arm, "msr_pct", 97, 97.186, 98);
  EXPECT_EQ(text("msr_pct"), "97.18");
  Set(arm, "msr_pct", 97, 96, 97.177);
  EXPECT_EQ(text("msr_pct"), "97.18✓");
  Set(arm, "msr_pct", 97, 96, 97.174);
  EXPECT_EQ(text("msr_pct"), "97.18");
  EXPECT_EQ(text("duration_max_min"), "~18");  // no interval, no mark
  EXPECT_EQ(text("mean_power_w"), "");
  arm.name = "ablation-4";
  Set(arm, "or_pct", 100, 99.5, 100);
  EXPECT_EQ(text("or_pct"), "100✓‡");
}

TEST(ResultTableTest, ShowsValuesIntervalsAndPaper) {
  const std::vector<metrics::ArmMetrics> arms = {Named("online", "ed3r-75")};
  const std::string table = tables::ResultTable(arms, paper::PaperClaims());
  EXPECT_NE(LineWith(table, "Stage online"), "");
  EXPECT_NE(LineWith(table, "flown").find(" 5"), std::string::npos);
  EXPECT_EQ(LineWith(table, "  total  "), "  total                   kJ   48.00   0.00–116.7  21.44✓†");
  EXPECT_EQ(LineWith(table, "mission, longest"), "  mission, longest       min   18.00               ~18");
  EXPECT_NE(table.find("ed3r-75 total_energy_kj 21.33 (C012)"), std::string::npos);
}

TEST(ResultTableTest, MissingValuesAreDashes) {
  const std::vector<metrics::ArmMetrics> arms = {
      metrics::ComputeMetrics({.stage = "online", .name = "rbs", .missions = {}, .missing = 850})};
  const std::string table = tables::ResultTable(arms, paper::PaperClaims());
  EXPECT_EQ(LineWith(table, "  total  "), "  total                   kJ       –            34.99");
  EXPECT_NE(LineWith(table, "still missing").find("850"), std::string::npos);
}

TEST(ResultTableTest, FitsTheTerminalAndShowsEveryArmOnce) {
  std::vector<metrics::ArmMetrics> arms;
  for (const char* name : {"ed3r-65", "ed3r-75", "ed3r-85", "ablation-1", "ablation-2", "ablation-3",
                           "ablation-4", "ecd2r", "rbs"})
    arms.push_back(Named("online", name));
  for (int width = 64; width <= 160; ++width) {
    const std::string table = tables::ResultTable(arms, paper::PaperClaims(), width);
    const std::vector<std::string> lines = Lines(table);
    int names = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_LE(tables::DisplayWidth(lines[i]), width) << lines[i];
      EXPECT_TRUE(lines[i].empty() || lines[i].back() != ' ') << lines[i];
      if (i + 1 == lines.size() || lines[i + 1].find("───") == std::string::npos) continue;
      for (const metrics::ArmMetrics& arm : arms) names += lines[i].find(' ' + arm.name) != std::string::npos;
    }
    EXPECT_EQ(names, 9) << width;
  }
}

TEST(ResultTableTest, StagesAreApartAndLongNamesHaveRoom) {
  const std::string name = "robot.mass_kg=1.816, robot.speed_mps=5, rfnn.training_seed=3";
  const std::vector<metrics::ArmMetrics> arms = {Named("warmup", "warmup"), Named("sensitivity", name),
                                                 Named("sensitivity", name + "4")};
  const std::string table = tables::ResultTable(arms, paper::PaperClaims());
  EXPECT_LT(table.find("Stage warmup"), table.find("Stage sensitivity"));
  EXPECT_NE(table.find(name + "\n"), std::string::npos);
  EXPECT_NE(table.find(name + "4\n"), std::string::npos);
  EXPECT_EQ(table.find("The paper gives no intervals"), std::string::npos);  // nothing of the paper is shown
}

TEST(ResultTableTest, NothingInNothingOut) { EXPECT_EQ(tables::ResultTable({}, paper::PaperClaims()), ""); }

TEST(GeneralisationTest, SplitsSitesAndStations) {
  const std::vector<tables::Generalisation> arms = {tables::ComputeGeneralisation(FiveMissions())};
  EXPECT_EQ(arms[0].known_sites.missions, 2);
  EXPECT_EQ(arms[0].unseen_stations.missions, 3);
  const std::string table = tables::GeneralisationTable(arms);
  EXPECT_EQ(LineWith(table, "fire site known").substr(0, 41), "  fire site known                2    9.8");
  EXPECT_NE(LineWith(table, "base station unseen").find("70.8"), std::string::npos);
  for (const std::string& line : Lines(table)) EXPECT_LE(tables::DisplayWidth(line), tables::kTerminalWidth);
}

TEST(GeneralisationTest, ArmsOnKnownPlacesOnlyAreLeftOut) {
  metrics::ArmData arm = FiveMissions();
  for (mission::MissionRecord& mission : arm.missions) mission.site_known = mission.base_station_known = 1;
  const std::vector<tables::Generalisation> arms = {tables::ComputeGeneralisation(arm)};
  EXPECT_EQ(tables::GeneralisationTable(arms), "");
}

TEST(JsonTest, HasTheContractsShape) {
  const std::vector<metrics::ArmMetrics> arms = {Named("online", "ed3r-75"), Named("online", "rbs")};
  const auto parsed = nlohmann::json::parse(tables::ResultJson(arms, paper::PaperClaims()).dump());
  const auto& rbs = parsed.at("arms").at("rbs");
  EXPECT_EQ(rbs.at("missions"), 5);
  EXPECT_EQ(rbs.at("failed"), 1);
  EXPECT_EQ(rbs.at("missing"), 2);
  EXPECT_EQ(rbs.at("total_energy_kj").at("mean"), 48);
  EXPECT_EQ(rbs.at("total_energy_kj").at("lo"), 0);
  EXPECT_NEAR(rbs.at("total_energy_kj").at("hi"), 116.671765, 1e-6);
  EXPECT_EQ(rbs.at("total_energy_kj").at("paper"), 34.99);
  EXPECT_TRUE(rbs.at("duration_max_min").at("lo").is_null());
  EXPECT_TRUE(rbs.at("lf_accuracy_pct").at("paper").is_null());
  for (const metrics::MetricDefinition& metric : metrics::MetricDefinitions())
    EXPECT_TRUE(parsed.at("arms").at("ed3r-75").contains(metric.name)) << metric.name;
}

TEST(JsonTest, EqualNamesOfTwoStagesAreToldApart) {
  const std::vector<metrics::ArmMetrics> arms = {Named("a", "rbs"), Named("b", "rbs"), Named("b", "ecd2r")};
  EXPECT_EQ(tables::UniqueArmNames(arms), (std::vector<std::string>{"a/rbs", "b/rbs", "ecd2r"}));
  EXPECT_EQ(tables::ResultJson(arms, paper::PaperClaims()).at("arms").size(), 3u);
}

TEST(CsvFileTest, HoldsEveryValueInFullPrecision) {
  const metrics::ArmMetrics arm = Named("online", "mass=1, speed=5");
  const std::vector<CsvRow> rows = CsvRows(tables::ResultCsv(std::vector{arm}, paper::PaperClaims()));
  ASSERT_EQ(rows.size(), 1 + 3 + metrics::MetricDefinitions().size());
  EXPECT_EQ(rows[0], (CsvRow{"stage", "arm", "metric", "value", "lo", "hi", "n", "paper"}));
  EXPECT_EQ(rows[1], (CsvRow{"online", "mass=1, speed=5", "missions", "5", "", "", "5", ""}));
  EXPECT_EQ(rows[3], (CsvRow{"online", "mass=1, speed=5", "missing", "2", "", "", "5", ""}));
  for (std::size_t i = 0; i < arm.values.size(); ++i) {
    EXPECT_EQ(rows[4 + i][2], metrics::MetricDefinitions()[i].name);
    EXPECT_EQ(std::stod(rows[4 + i][3]), arm.values[i].value);
    EXPECT_EQ(rows[4 + i][5], std::isnan(arm.values[i].hi) ? "" : fmt::format("{}", arm.values[i].hi));
  }
  const std::vector<CsvRow> paper =
      CsvRows(tables::ResultCsv(std::vector{Named("online", "rbs")}, paper::PaperClaims()));
  EXPECT_EQ(paper[4][7], "34.99");
}

TEST(CsvFileTest, GeneralisationHasFourPlaces) {
  const std::vector<tables::Generalisation> arms = {tables::ComputeGeneralisation(FiveMissions())};
  const std::vector<CsvRow> rows = CsvRows(tables::GeneralisationCsv(arms));
  ASSERT_EQ(rows.size(), 1 + 4 * metrics::MetricDefinitions().size());
  EXPECT_EQ(rows[1][2], "known-site");
  EXPECT_EQ(rows[1][3], "total_energy_kj");
  EXPECT_EQ(rows[1][4], "9.8");
  const nlohmann::ordered_json json = tables::GeneralisationJson(arms);
  EXPECT_EQ(json.at("ed3r-75").at("unseen-base-station").at("missions"), 3);
}

}  // namespace
}  // namespace ed3r
