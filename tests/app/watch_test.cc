// `ed3r status --watch` and `--html`, `ed3r replay --html`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

class WatchTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    const CommandResult flown =
        Ed3r(fmt::format("run {}/sweeps/rbs.yaml --missions 6 --quiet --out {}", ED3R_SOURCE_DIR, Run()));
    ASSERT_EQ(flown.status, 0) << flown.err;
    for (const char* name : {"viewer.js", "viewer.css"}) std::ofstream(*scratch_ / name) << "program";
  }
  static void TearDownTestSuite() { delete scratch_; }
  static std::string Run() { return (*scratch_ / "run").string(); }
  static std::string Web() { return "ED3R_WEB=" + scratch_->Path().string(); }

  // What the viewer's page reads.
  static nlohmann::json DataOf(const fs::path& page) {
    const std::string text = ReadAll(page), opening = "id=\"page-data\">";
    const auto begin = text.find(opening) + opening.size();
    return nlohmann::json::parse(text.substr(begin, text.find("</script>", begin) - begin));
  }

  static ScratchFolder* scratch_;
  ScratchFolder out_;
};
ScratchFolder* WatchTest::scratch_ = nullptr;

TEST_F(WatchTest, ARunThatHasEndedIsShownOnce) {
  const std::string page = (out_ / "status.html").string();
  const CommandResult result = Ed3r(fmt::format("status {} --watch --html {}", Run(), page));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("6 of 6 missions, nothing missing"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(" kJ\n"), std::string::npos) << result.out;
  EXPECT_EQ(ReadAll(page).find("http-equiv=\"refresh\""), std::string::npos) << "nothing more comes";
  EXPECT_NE(ReadAll(page).find("6 of 6 missions"), std::string::npos);
}

TEST_F(WatchTest, ABatchSystemsSignalEndsALookAsItEndsARun) {
  const std::string half = (out_ / "half").string();
  ASSERT_EQ(Ed3r(fmt::format("run {}/sweeps/rbs.yaml --missions 6 --shard 1/2 --quiet --out {}",
                             ED3R_SOURCE_DIR, half))
                .status,
            0);
  for (const auto& [signal, status] : {std::pair("TERM", 75), std::pair("INT", 130)}) {
    const CommandResult result = Ed3r(fmt::format("status {} --watch", half),
                                      fmt::format("timeout --preserve-status -s {} 3", signal));
    EXPECT_EQ(result.status, status) << signal;
    EXPECT_NE(result.out.find("3 of 6 missions"), std::string::npos) << result.out;
    EXPECT_EQ(result.err, status == 75 ? "ended by SIGTERM\n" : "") << signal;
  }
}

TEST_F(WatchTest, AViewerHoldsTheFlightAndItsDecisions) {
  const std::string out = (out_ / "replay").string();
  const CommandResult result =
      Ed3r(fmt::format("replay {} rbs/2 --beside rbs/3 --html --out {}", Run(), out), Web());
  ASSERT_EQ(result.status, 0) << result.err;
  const auto data = DataOf(fs::path(out) / "mission.html");
  ASSERT_EQ(data.at("missions").size(), 2u);
  for (const auto& mission : data.at("missions")) {
    EXPECT_TRUE(mission.at("identical").get<bool>());
    const auto& steps = mission.at("steps");
    const std::size_t timesteps = steps.at("k").size();
    EXPECT_EQ(mission.at("decisions").size(), timesteps);
    EXPECT_TRUE(mission.at("frames").is_null()) << "it looked at no pixels";
    const double range_m = mission.at("lidar").at("range_m");
    const auto& track = mission.at("track");
    ASSERT_FALSE(mission.at("lidar").at("met").empty()) << "a robot below 30 m meets the ground";
    for (const auto& met : mission.at("lidar").at("met")) {
      const std::size_t at = met[0];
      ASSERT_LT(at, track.at("t_s").size());
      const double from[] = {track.at("x_m")[at], track.at("y_m")[at], track.at("z_m")[at]};
      double square_m2 = 0.0;
      for (int i = 0; i < 3; ++i) {
        const double along_m = met[1 + i].get<double>() - from[i];
        square_m2 += along_m * along_m;
      }
      EXPECT_LE(std::sqrt(square_m2), range_m + 0.2) << "given its rounding";
    }
    EXPECT_NEAR(steps.at("begin_s").back().get<double>() + steps.at("duration_s").back().get<double>(),
                mission.at("duration_s").get<double>(), 1e-3);
    EXPECT_EQ(mission.at("track").at("t_s").size(), mission.at("track").at("z_m").size());
    double last = -1;
    for (const double t : mission.at("track").at("t_s")) EXPECT_GE(t, last), last = t;
    for (const auto& decision : mission.at("decisions"))
      EXPECT_FALSE(decision.at("execution_text").get<std::string>().empty());
  }
  EXPECT_GT(data.at("world").at("trees").size(), 100u);
}

TEST_F(WatchTest, WithoutItsProgramAViewerIsRefusedBeforeAnythingIsWritten) {
  const std::string out = (out_ / "replay").string();
  const CommandResult result =
      Ed3r(fmt::format("replay {} rbs/2 --html --out {}", Run(), out), "ED3R_WEB=/nonexistent");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("scripts/setup --web"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(Ed3r(fmt::format("replay {} rbs/2 --beside rbs/3 --out {}", Run(), out)).status, 2);
}

TEST_F(WatchTest, AReportLinksMissionsToWatch) {
  for (const char* name : {"report.js", "report.css"}) std::ofstream(*scratch_ / name) << "program";
  const std::string out = (out_ / "report").string();
  ASSERT_EQ(Ed3r(fmt::format("report {} --no-figures --out {}", Run(), out), Web()).status, 0);
  const auto viewers = DataOf(fs::path(out) / "index.html").at("viewers");
  ASSERT_FALSE(viewers.empty());
  for (const auto& viewer : viewers) {
    const auto data = DataOf(fs::path(out) / viewer.at("file").get<std::string>());
    EXPECT_EQ(data.at("missions").at(0).at("name"), viewer.at("mission"));
  }
}

}  // namespace
}  // namespace ed3r::app
