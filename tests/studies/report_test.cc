#include "studies/report/report.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/check.h"
#include "studies/report/old_report.h"
#include "tests/claims/synthetic_run.h"
#include "tests/studies/five_missions.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

report::RunResults OneArm() { return {.name = "paper", .arms = {FiveMissions()}}; }

std::string Content(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class ReportFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }
  fs::path dir_;
};

TEST(ReportTest, TextHasItsParts) {
  const std::string text = report::ReportText(report::MakeReport(OneArm(), {}));
  EXPECT_TRUE(text.starts_with("paper\n\nStage online\n"));
  EXPECT_NE(text.find("success (MSR)"), std::string::npos);
  EXPECT_NE(text.find("base station unseen"), std::string::npos);
}

TEST(ReportTest, RunWithoutMissionsSaysSo) {
  EXPECT_EQ(report::ReportText(report::MakeReport({.name = "empty", .arms = {}}, {})),
            "empty\n\nNo missions.\n");
}

TEST(ReportTest, JsonHasArmsAndGeneralisation) {
  const auto json = nlohmann::json::parse(report::ReportJson(report::MakeReport(OneArm(), {})).dump());
  EXPECT_EQ(json.at("name"), "paper");
  EXPECT_EQ(json.at("arms").at("ed3r-75").at("msr_pct").at("mean"), 60);
  EXPECT_EQ(json.at("generalisation").at("ed3r-75").at("known-site").at("missions"), 2);
}

TEST(ReportTest, P85TablesHaveTheIntervalsOfTheClaims) {
  const std::vector<metrics::ArmData> arms = {claims::MakeArm({"ed3r-75", 20, 0.02, 0.3}),
                                              claims::MakeArm({"rbs", 35, 0.2, 0, false})};
  const report::Report report = report::MakeReport({.name = "x", .arms = arms}, {});
  int compared = 0;
  for (const tables::StudyTable& table : report.tables)
    for (const metrics::ArmMetrics& arm : table.arms)
      for (const claims::JudgedClaim& judged : report.claims.claims) {
        if (judged.claim.strategy != arm.name || judged.claim.id != "C122") continue;
        ++compared;
        const metrics::MetricValue value = arm["total_energy_kj"];
        EXPECT_EQ(value.lo, judged.all.lo);
        EXPECT_EQ(value.hi, judged.all.hi);
        EXPECT_LT(value.lo, metrics::ComputeP85(arms[0])["total_energy_kj"].lo)
            << "the luck of training is in it";
      }
  EXPECT_EQ(compared, 1);
}

TEST(ReportTest, IsTheSameEveryTime) {
  EXPECT_EQ(report::ReportText(report::MakeReport(OneArm(), {})),
            report::ReportText(report::MakeReport(OneArm(), {})));
  EXPECT_EQ(report::ReportJson(report::MakeReport(OneArm(), {})).dump(),
            report::ReportJson(report::MakeReport(OneArm(), {})).dump());
}

TEST_F(ReportFilesTest, AreWrittenAndReplaced) {
  const report::Report report = report::MakeReport(OneArm(), {});
  for (int round = 0; round < 2; ++round) {
    report::WriteReport(report, (dir_ / "deep").string());
    EXPECT_EQ(Content(dir_ / "deep/report.txt"), report::ReportText(report));
    EXPECT_EQ(nlohmann::ordered_json::parse(Content(dir_ / "deep/report.json")), report::ReportJson(report));
    EXPECT_TRUE(Content(dir_ / "deep/metrics.csv").starts_with("stage,arm,metric,value,lo,hi,n,paper\n"));
    EXPECT_TRUE(
        Content(dir_ / "deep/generalisation.csv").starts_with("stage,arm,place,metric,value,lo,hi,n\n"));
  }
  int files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(dir_ / "deep")) ++files;
  EXPECT_EQ(files, 8);  // seven files and the tables' folder; nothing unfinished is left behind
  for (const char* ending : {"md", "tex", "csv", "json"})
    EXPECT_FALSE(Content(dir_ / "deep/tables" / ("arms." + std::string(ending))).empty()) << ending;
}

// Tables of an earlier report would be taken for this one's.
TEST_F(ReportFilesTest, ThoseOfAnEarlierReportGoAndThoseOfOthersStay) {
  fs::create_directories(dir_ / "tables");
  const std::vector<std::string> stale = {"by_network.csv",       "differences.csv",
                                          "variants.csv",         "variant_verdicts.csv",
                                          "tables/baselines.tex", "tables/variants.json"};
  const std::vector<std::string> others = {"notes.csv", "tables/mine.md"};
  for (const std::vector<std::string>* names : {&stale, &others})
    for (const std::string& name : *names) std::ofstream(dir_ / name) << "of before";
  report::RemoveOldReport(dir_);
  for (const std::string& name : stale) EXPECT_FALSE(fs::exists(dir_ / name)) << name;
  for (const std::string& name : others) EXPECT_EQ(Content(dir_ / name), "of before");
}

TEST_F(ReportFilesTest, UnwritablePlacesAreUserErrors) {
  fs::create_directories(dir_ / "report.txt");  // a folder in the file's place
  std::ofstream(dir_ / "report.txt" / "x") << "x";
  EXPECT_THROW(report::WriteReport(report::MakeReport(OneArm(), {}), dir_.string()), UserError);
  std::ofstream(dir_ / "file") << "x";
  EXPECT_THROW(report::WriteReport(report::MakeReport(OneArm(), {}), (dir_ / "file" / "below").string()),
               UserError);
}

}  // namespace
}  // namespace ed3r
