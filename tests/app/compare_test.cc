// `ed3r compare`: runs flown apart, told as one table.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

// Two runs of the same missions, of which the second's battery is smaller.
class CompareTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    for (const auto& [name, options] :
         {std::pair{"usual", ""}, std::pair{"small", "--set robot.battery_mah=1000"}}) {
      const CommandResult flown = Ed3r(fmt::format("run {}/sweeps/rbs.yaml --missions 28 --quiet --out {} {}",
                                                   ED3R_SOURCE_DIR, Dir(name), options));
      ASSERT_EQ(flown.status, 0) << flown.err;
    }
  }
  static void TearDownTestSuite() { delete scratch_; }
  static std::string Dir(const std::string& name) { return (*scratch_ / name).string(); }

  static ScratchFolder* scratch_;
};
ScratchFolder* CompareTest::scratch_ = nullptr;

TEST_F(CompareTest, DifferencesArePairedAndWritten) {
  const std::string out = Dir("compared");
  const CommandResult result =
      Ed3r(fmt::format("compare {} {} --json --out {}", Dir("usual"), Dir("small"), out));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("runs"), (nlohmann::json{"usual", "small"}));
  const auto& energy = json.at("differences").at(0);
  EXPECT_EQ(energy.at("arm"), "rbs");
  EXPECT_EQ(energy.at("run"), "small");
  EXPECT_EQ(energy.at("metric"), "total_energy_kj");
  EXPECT_EQ(energy.at("pairs"), 28);
  EXPECT_LT(energy.at("difference"), 0.0) << "a smaller battery ends missions earlier";
  EXPECT_LE(energy.at("lo"), energy.at("difference"));
  for (const char* file : {"compare.txt", "differences.csv", "verdicts.csv", "manifest.json"})
    EXPECT_FALSE(ReadAll(fs::path(out) / file).empty()) << file;
}

TEST_F(CompareTest, WorldsOfOneNameThatDifferAreTold) {
  const ScratchFolder scratch;
  fs::copy_file(ED3R_SOURCE_DIR "/sweeps/worlds/ridges.yaml", scratch / "world.yaml");
  std::ofstream(scratch / "study.yaml")
      << "name: study\nseed: 2\nmissions: 2\nset: {mission.world: world.yaml, strategy: rbs}\n";
  const auto fly = [&](const std::string& name) {
    const CommandResult flown = Ed3r(
        fmt::format("run {} --quiet --out {}", (scratch / "study.yaml").string(), (scratch / name).string()));
    ASSERT_EQ(flown.status, 0) << flown.err;
  };
  fly("before");
  fly("same");
  std::string world = ReadAll(scratch / "world.yaml");
  const std::size_t seed = world.find("\nseed: ");
  ASSERT_NE(seed, std::string::npos);
  world.insert(seed + std::string("\nseed: ").size(), "1");
  std::ofstream(scratch / "world.yaml") << world;
  fly("after");
  const auto told = [&](const std::string& name) {
    return nlohmann::json::parse(Ed3r(fmt::format("compare {} {} --json", (scratch / "before").string(),
                                                  (scratch / name).string()))
                                     .out)
        .at("other_contents");
  };
  EXPECT_EQ(told("same"), nlohmann::json::array());
  EXPECT_EQ(told("after"),
            (nlohmann::json{"after: world.yaml is not what it is in before: its content differs."}));
}

TEST_F(CompareTest, ThePaperIsJudgedOnlyWhereEveryRunFlewIt) {
  const std::string both = fmt::format("compare {} {}", Dir("usual"), Dir("small"));
  const CommandResult left_out = Ed3r(both), asked = Ed3r(both + " --claims");
  EXPECT_TRUE(left_out.out.starts_with(
      "small: not as in the paper: robot.battery_mah 1000 (paper 3500).\nSo the paper's "
      "claims are not judged; --claims judges them all the same.\n\n"))
      << left_out.out.substr(0, 300);
  EXPECT_EQ(left_out.out.find("Claims of the paper"), std::string::npos);
  EXPECT_NE(asked.out.find("Claims of the paper"), std::string::npos);
  EXPECT_NE(asked.out.find("judged all the same (--claims)"), std::string::npos);
}

TEST_F(CompareTest, ARunEqualsItself) {
  fs::copy(Dir("usual"), Dir("again"), fs::copy_options::recursive);
  const CommandResult result = Ed3r(fmt::format("compare {} {}/", Dir("usual"), Dir("again")));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("again: 0 of 177 claims"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("of other seeds"), std::string::npos) << result.out;
}

TEST_F(CompareTest, OtherSeedsAreSaid) {
  const CommandResult flown = Ed3r(fmt::format(
      "run {}/sweeps/rbs.yaml --missions 28 --seed 5 --quiet --out {}", ED3R_SOURCE_DIR, Dir("reseeded")));
  ASSERT_EQ(flown.status, 0) << flown.err;
  const CommandResult result = Ed3r(fmt::format("compare {} {}", Dir("usual"), Dir("reseeded")));
  EXPECT_NE(result.out.find("of other seeds"), std::string::npos) << result.out;
}

TEST_F(CompareTest, WhatCannotBeComparedIsSaid) {
  const CommandResult one = Ed3r("compare " + Dir("usual"));
  EXPECT_EQ(one.status, 2);
  EXPECT_NE(one.err.find("at least two are needed"), std::string::npos) << one.err;
  const CommandResult same = Ed3r(fmt::format("compare {0} {0}", Dir("usual")));
  EXPECT_EQ(same.status, 2);
  EXPECT_NE(same.err.find("their names must differ"), std::string::npos) << same.err;
  const CommandResult none = Ed3r(fmt::format("compare {} {}", Dir("usual"), Dir("nowhere")));
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("nowhere"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace ed3r::app
