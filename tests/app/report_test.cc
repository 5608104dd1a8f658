// `ed3r report` as its users meet it: what it leaves in a folder, with pictures and without.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

class ReportTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    const CommandResult flown = Ed3r(fmt::format("run {}/sweeps/rbs.yaml --missions 24 --quiet --out {}",
                                                 ED3R_SOURCE_DIR, (*scratch_ / "run").string()));
    ASSERT_EQ(flown.status, 0) << flown.err;
  }
  static void TearDownTestSuite() { delete scratch_; }

  void SetUp() override {
    fs::create_directories(out_ / "web");
    std::ofstream(out_ / "web" / "report.js") << "the program";
    std::ofstream(out_ / "web" / "report.css") << "the style";
  }

  // Reports the run of this suite into a folder of this test; the page's program is a stand-in of this test.
  CommandResult Report(const std::string& options, const std::string& environment = "") {
    return Ed3r(fmt::format("report {} --out {} {}", (*scratch_ / "run").string(), Out().string(), options),
                "ED3R_WEB=" + (out_ / "web").string() + ' ' + environment);
  }
  fs::path Out() const { return out_ / "report"; }

  // A folder with a plot.py of this content.
  fs::path Script(const std::string& content) {
    fs::create_directories(out_ / "scripts");
    std::ofstream(out_ / "scripts" / "plot.py") << content;
    return out_ / "scripts";
  }

  static bool HasMatplotlib() {
    return std::system("/usr/bin/python3 -c 'import matplotlib' >/dev/null 2>&1") == 0;
  }

  static ScratchFolder* scratch_;
  ScratchFolder out_;
};
ScratchFolder* ReportTest::scratch_ = nullptr;

TEST_F(ReportTest, DrawsWhatItsDataList) {
  if (!HasMatplotlib()) GTEST_SKIP() << "matplotlib is not installed";
  const CommandResult result = Report("");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find(Out().string() + ": index.html"), std::string::npos);
  const auto data = nlohmann::json::parse(ReadAll(Out() / "figures" / "data.json"));
  const std::string page = ReadAll(Out() / "index.html"), captions = ReadAll(Out() / "figures" / "README.md");
  ASSERT_EQ(data.at("figures").size(), 5u);  // overview, insights, decisions, sites, map
  for (const auto& figure : data.at("figures")) {
    const std::string id = figure.at("id");
    EXPECT_TRUE(ReadAll(Out() / "figures" / (id + ".png")).starts_with("\x89PNG")) << id;
    EXPECT_NE(ReadAll(Out() / "figures" / (id + ".svg")).find("<svg"), std::string::npos) << id;
    EXPECT_NE(page.find("src=\"figures/" + id + ".png\""), std::string::npos) << id;
    EXPECT_NE(captions.find("](" + id + ".png)\n\n" + figure.at("caption").get<std::string>() + '\n'),
              std::string::npos)
        << id;
    EXPECT_NE(captions.find(". " + figure.at("title").get<std::string>() + '\n'), std::string::npos) << id;
  }
  ASSERT_FALSE(data.at("world").is_null()) << data.at("world_note");
  EXPECT_FALSE(fs::exists(Out() / "figures" / "plot.log"));
}

// A locale that reads text as something else must not change a label.
TEST_F(ReportTest, ItsDataAreUtf8InEveryLocale) {
  if (!HasMatplotlib()) GTEST_SKIP() << "matplotlib is not installed";
  ASSERT_EQ(Report("--no-figures").status, 0);
  const fs::path figures = Out() / "figures";
  std::string data = ReadAll(figures / "data.json");
  const std::string label = "\"label\":\"RBS\"";
  const std::size_t at = data.find(label);
  ASSERT_NE(at, std::string::npos) << data;
  std::ofstream(figures / "data.json") << data.replace(at, label.size(), "\"label\":\"ED\u00b3R\"");
  const auto drawn_in = [&](const std::string& locale) {
    const std::string line = fmt::format(
        "PYTHONUTF8=0 PYTHONCOERCECLOCALE=0 LC_ALL={} /usr/bin/python3 -B {}/scripts/plot.py {} "
        "overview-arms-1",
        locale, ED3R_SOURCE_DIR, figures.string());
    EXPECT_EQ(std::system(line.c_str()), 0) << line;
    return ReadAll(figures / "overview-arms-1.svg");
  };
  const std::string in_utf8 = drawn_in("C.UTF-8");
  EXPECT_GT(in_utf8.size(), 0u);
  EXPECT_EQ(drawn_in("C"), in_utf8);
}

TEST_F(ReportTest, WithoutFiguresWritesAllElse) {
  const CommandResult result = Report("--no-figures", "ED3R_PYTHON=/nonexistent/python3");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "note: figures not drawn (--no-figures)\n");
  for (const char* file :
       {"index.html", "report.txt", "report.json", "metrics.csv", "generalisation.csv", "tables/arms.md",
        "tables/arms.tex", "tables/arms.csv", "tables/arms.json", "figures/data.json", "figures/README.md"})
    EXPECT_GT(ReadAll(Out() / file).size(), 0u) << file;
  EXPECT_NE(ReadAll(Out() / "index.html").find("figures not drawn"), std::string::npos);
  EXPECT_EQ(ReadAll(Out() / "figures" / "README.md").find(".png"), std::string::npos);
}

TEST_F(ReportTest, APythonThatIsMissingIsANote) {
  const CommandResult result = Report("", "ED3R_PYTHON=/nonexistent/python3");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err,
            "note: figures not drawn: /nonexistent/python3: No such file or directory; set ED3R_PYTHON\n");
  EXPECT_TRUE(fs::exists(Out() / "index.html"));
}

TEST_F(ReportTest, AMatplotlibThatIsMissingIsANote) {
  const fs::path scripts = Script("import sys\nprint('no matplotlib', file=sys.stderr)\nsys.exit(3)\n");
  const CommandResult result = Report("", "ED3R_SCRIPTS=" + scripts.string());
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "note: figures not drawn: no matplotlib\n");
}

TEST_F(ReportTest, AScriptThatIsMissingIsANote) {
  const CommandResult result = Report("", "ED3R_SCRIPTS=/nonexistent");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err,
            "note: figures not drawn: /nonexistent/plot.py is not there; set ED3R_SCRIPTS to its folder\n");
}

TEST_F(ReportTest, APlotThatFailsIsAFailureWithItsLine) {
  const fs::path scripts = Script("raise ValueError('no colour left')\n");
  const CommandResult result = Report("", "ED3R_SCRIPTS=" + scripts.string());
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("figures: drawing failed: ValueError: no colour left"), std::string::npos)
      << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_TRUE(fs::exists(Out() / "index.html"));
  EXPECT_NE(ReadAll(Out() / "figures" / "plot.log").find("Traceback"), std::string::npos);
}

TEST_F(ReportTest, PicturesOfAnEarlierReportDoNotStayAndThoseOfOthersDo) {
  const fs::path figures = Out() / "figures";
  ASSERT_EQ(Report("--no-figures").status, 0);
  std::ofstream(figures / "overview-other.png") << "drawn by a report";
  std::ofstream(figures / "holiday.png") << "mine";
  std::ofstream(figures / "logo.svg") << "mine";
  auto data = nlohmann::json::parse(ReadAll(figures / "data.json"));
  data["figures"].push_back({{"id", "overview-other"}});
  data["figures"].push_back({{"id", "../holiday"}});
  std::ofstream(Out() / "holiday.png") << "mine";
  std::ofstream(figures / "data.json") << data.dump();
  EXPECT_EQ(Report("--no-figures").status, 0);
  EXPECT_FALSE(fs::exists(figures / "overview-other.png"));
  EXPECT_EQ(ReadAll(figures / "holiday.png"), "mine");
  EXPECT_EQ(ReadAll(figures / "logo.svg"), "mine");
  EXPECT_EQ(ReadAll(Out() / "holiday.png"), "mine");
}

TEST_F(ReportTest, MissionPagesOfAnEarlierReportDoNotStayAndThoseOfOthersDo) {
  ASSERT_EQ(Report("--no-figures --no-missions").status, 0);
  const fs::path missions = Out() / "missions";
  fs::create_directories(missions);
  std::ofstream(missions / "online-ecd2r-7.html") << "<title>online/ecd2r/7 – ED³R mission</title>";
  std::ofstream(missions / "best.html") << "<title>online/ecd2r/7 – ED³R mission</title>";
  ASSERT_EQ(Report("--no-figures --no-missions").status, 0);
  EXPECT_FALSE(fs::exists(missions / "online-ecd2r-7.html"));
  EXPECT_TRUE(fs::exists(missions / "best.html"));
}

TEST_F(ReportTest, OneThatDidNotComeToItsEndHasNoPageAndNothingOfBefore) {
  ASSERT_EQ(Report("--no-figures --no-missions").status, 0);
  std::ofstream(Out() / "differences.csv") << "of before";
  fs::remove(Out() / "verdicts.csv");
  fs::create_directories(Out() / "verdicts.csv");  // in the way
  EXPECT_EQ(Report("--no-figures --no-missions").status, 2);
  for (const char* name : {"index.html", "differences.csv", "look_forward.csv", "figures/data.json"})
    EXPECT_FALSE(fs::exists(Out() / name)) << name;
  fs::remove(Out() / "verdicts.csv");
  EXPECT_EQ(Report("--no-figures --no-missions").status, 0) << "its manifest says that it is a report";
}

// Pictures are drawn between what figures and what the page tell.
TEST_F(ReportTest, IsOfOneStateThoughTheRunIsReplacedMeanwhile) {
  const fs::path run = out_ / "run", other = out_ / "other";
  fs::create_directories(run);
  fs::copy_file(*scratch_ / "run" / "results.sqlite", run / "results.sqlite");
  ASSERT_EQ(Ed3r(fmt::format("run {}/sweeps/rbs.yaml --missions 3 --quiet --out {}", ED3R_SOURCE_DIR,
                             other.string()))
                .status,
            0);
  std::ofstream(out_ / "python") << "#!/bin/sh\nmv " << (other / "results.sqlite").string() << ' '
                                 << (run / "results.sqlite").string() << '\n';
  fs::permissions(out_ / "python", fs::perms::owner_all);
  const CommandResult result =
      Ed3r(fmt::format("report {} --no-missions --out {}", run.string(), Out().string()),
           "ED3R_WEB=" + (out_ / "web").string() + " ED3R_PYTHON=" + (out_ / "python").string());
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string page = ReadAll(Out() / "index.html");
  const std::string opening = "<script type=\"application/json\" id=\"page-data\">";
  const auto begin = page.find(opening) + opening.size();
  const auto data = nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  EXPECT_EQ(data.at("points").at(0).at("number").size(), 24u);
  EXPECT_EQ(data.at("run").at("missions"), 24);
  EXPECT_EQ(nlohmann::json::parse(Ed3r("digest --json " + run.string()).out).at("missions"), 3);
}

TEST_F(ReportTest, TwoCommandsDoNotMixTheirTablesInOneFolder) {
  const std::string run = (*scratch_ / "run").string(), out = Out().string();
  ASSERT_EQ(Report("--no-figures --no-missions").status, 0);
  const std::string page = ReadAll(Out() / "index.html");
  const int held = open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(held, LOCK_EX), 0);
  for (const std::string& command : {"report --no-figures --no-missions " + run, "export --csv " + run}) {
    const CommandResult refused = Ed3r(command + " --out " + out);
    EXPECT_EQ(refused.status, 2) << command;
    EXPECT_NE(refused.err.find(out + ": another ed3r is writing into this folder"), std::string::npos)
        << refused.err;
  }
  close(held);
  EXPECT_EQ(ReadAll(Out() / "index.html"), page);
  EXPECT_FALSE(fs::exists(Out() / "missions.csv"));
  EXPECT_EQ(Report("--no-figures --no-missions").status, 0);
}

TEST_F(ReportTest, AFolderOfSomebodyIsLeftAloneWithoutForce) {
  fs::create_directories(Out());
  std::ofstream(Out() / "thesis.txt") << "mine";
  const CommandResult refused = Report("--no-figures");
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err,
            Out().string() +
                ": is there and is no report; --force writes the report's files into it all the same\n");
  EXPECT_FALSE(fs::exists(Out() / "report.txt"));
  std::ofstream(Out() / "variants.csv") << "mine";
  EXPECT_EQ(Report("--no-figures --force").status, 0);
  EXPECT_EQ(ReadAll(Out() / "thesis.txt"), "mine");
  EXPECT_EQ(ReadAll(Out() / "variants.csv"), "mine") << "this report has none, and there was no other";
  EXPECT_EQ(Report("--no-figures").status, 0) << "now it is a report";
  EXPECT_FALSE(fs::exists(Out() / "variants.csv"));
}

TEST_F(ReportTest, LinksAreNotFollowed) {
  ASSERT_EQ(Report("--no-figures").status, 0);
  const fs::path victim = out_ / "victim";
  std::ofstream(victim) << "mine";
  for (const char* name :
       {"index.html.tmp", "report.txt.tmp", "report.txt", "figures/plot.log", "figures/data.json"}) {
    fs::remove(Out() / name);
    fs::create_symlink(victim, Out() / name);
  }
  const fs::path scripts = Script("raise ValueError('no colour left')\n");
  EXPECT_EQ(Report("", "ED3R_SCRIPTS=" + scripts.string()).status, 1);
  EXPECT_EQ(ReadAll(victim), "mine");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(Out() / "report.txt")));
}

TEST_F(ReportTest, JsonIsAllThatItPrints) {
  const CommandResult result = Report("--json --no-figures");
  ASSERT_EQ(result.status, 0);
  EXPECT_EQ(nlohmann::json::parse(result.out).at("arms").at("rbs").at("missions"), 24);
}

TEST_F(ReportTest, ThePageTellsWhatWasRun) {
  ASSERT_EQ(Report("--no-figures").status, 0);
  const std::string page = ReadAll(Out() / "index.html");
  std::string digest = Ed3r("digest " + (*scratch_ / "run").string()).out;
  digest.pop_back();
  EXPECT_NE(page.find(digest), std::string::npos);
  for (const char* part : {"rbs.yaml --missions 24 --out", "24 of 24 planned", "20260101", "SIMD", "commit "})
    EXPECT_NE(page.find(part), std::string::npos) << part;
}

TEST_F(ReportTest, ThePageHasEverythingInIt) {
  ASSERT_EQ(Report("--no-figures").status, 0);
  const std::string page = ReadAll(Out() / "index.html");
  EXPECT_NE(page.find("<style>the style</style>"), std::string::npos);
  EXPECT_NE(page.find("<script>the program</script>"), std::string::npos);
  const std::string opening = "<script type=\"application/json\" id=\"page-data\">";
  const auto begin = page.find(opening) + opening.size();
  const auto data = nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  EXPECT_TRUE(data.at("question").get<std::string>().starts_with("What does the rule-based baseline cost"));
  EXPECT_EQ(data.at("arms").at(0).at("stored_name"), "online/rbs");
  EXPECT_EQ(data.at("points").at(0).at("number").size(), 24u);
  const auto report = nlohmann::json::parse(ReadAll(Out() / "report.json"));
  EXPECT_EQ(data.at("slices").at("all|all").at(0).at(1),
            report.at("arms").at("rbs").at("total_energy_kj").at("mean"));
}

TEST_F(ReportTest, WithoutItsProgramThePageIsPlainAndTheNoteSaysWhatMakesIt) {
  const CommandResult result = Report("--no-figures", "ED3R_WEB=/nonexistent");
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("note: the interactive page is not made: /nonexistent/report.js"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("'scripts/setup --web' makes it\n"), std::string::npos) << result.err;
  const std::string page = ReadAll(Out() / "index.html");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("id=\"headline\""), std::string::npos);
}

// What a report of RBS with these settings says of the paper: {report.json, report.txt, index.html}.
struct Judged {
  nlohmann::json json;
  std::string text, page;
};
Judged JudgedWith(const ScratchFolder& scratch, const std::string& settings,
                  const std::string& options = "") {
  const std::string run = (scratch / "judged").string(), out = (scratch / "judged-report").string();
  fs::remove_all(run);
  const CommandResult flown = Ed3r(
      fmt::format("run {}/sweeps/rbs.yaml --missions 3 --quiet {} --out {}", ED3R_SOURCE_DIR, settings, run));
  EXPECT_EQ(flown.status, 0) << flown.err;
  const CommandResult told =
      Ed3r(fmt::format("report {} --no-figures --no-missions {} --out {}", run, options, out),
           "ED3R_WEB=/nonexistent");
  EXPECT_EQ(told.status, 0) << told.err;
  return {nlohmann::json::parse(ReadAll(fs::path(out) / "report.json")),
          ReadAll(fs::path(out) / "report.txt"), ReadAll(fs::path(out) / "index.html")};
}

TEST_F(ReportTest, ThePaperIsJudgedOnlyWhereItWasFlown) {
  const Judged paper = JudgedWith(out_, "");
  EXPECT_TRUE(paper.json.at("paper").at("paper_flown"));
  EXPECT_FALSE(paper.json.at("claims").empty());
  EXPECT_NE(paper.text.find("Unlike the paper, in numbers alone: 3 missions of online (paper 850)."),
            std::string::npos);
  EXPECT_NE(paper.page.find("id=\"verdicts\""), std::string::npos);

  const Judged heavy = JudgedWith(out_, "--set robot.mass_kg=2.4");
  EXPECT_FALSE(heavy.json.at("paper").at("claims_judged"));
  EXPECT_TRUE(heavy.json.at("claims").empty());
  for (const std::string& text : {heavy.text, heavy.page})
    EXPECT_NE(
        text.find("Not as in the paper: robot.mass_kg 2.4 (paper 1.816). So its claims are not judged;"),
        std::string::npos)
        << text.substr(0, 500);
  EXPECT_EQ(heavy.page.find("id=\"verdicts\""), std::string::npos);
  EXPECT_FALSE(JudgedWith(out_, "--set robot.mass_kg=2.4", "--claims").json.at("claims").empty());
}

TEST_F(ReportTest, TheWorldIsThePapersByWhatIsInItsFiles) {
  const fs::path worlds = std::string(ED3R_SOURCE_DIR) + "/sweeps/worlds";
  for (const char* file : {"paper.yaml", "ridges.yaml"}) fs::copy_file(worlds / file, out_ / file);
  const std::string setting = "--set mission.world=" + (out_ / "paper.yaml").string();
  EXPECT_TRUE(JudgedWith(out_, setting).json.at("paper").at("paper_flown"));
  std::ofstream(out_ / "ridges.yaml", std::ios::app) << "# mine\n";
  const Judged mine = JudgedWith(out_, setting);
  EXPECT_EQ(mine.json.at("paper").at("results").at(0).at("parameter"), "mission.world");
  EXPECT_TRUE(mine.json.at("claims").empty());
}

TEST_F(ReportTest, AFolderWithoutARunIsBadInput) {
  const CommandResult result = Ed3r("report " + Out().string());
  EXPECT_EQ(result.status, 2);
  EXPECT_FALSE(fs::exists(Out()));
}

}  // namespace
}  // namespace ed3r::app
