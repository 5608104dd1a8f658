#include <gtest/gtest.h>

#include "engine/config/parameters.h"
#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

constexpr const char* kStudy =
    "name: x\nmissions: 10\nseed: 5\nset: {robot.mass_kg: 2}\nsweep: {strategy: [rbs, random]}\n";

SweepOverrides Set(std::vector<std::string> set) { return {std::move(set), {}, {}}; }

TEST(OverridesTest, WinOverSetAtEveryLevel) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1\nset: {robot.mass_kg: 2}\n"
      "stages:\n  - {name: a, set: {robot.mass_kg: 3}}\n  - {name: b}\n",
      Set({"robot.mass_kg=4", "robot.speed_mps=2"}));
  for (const Stage& stage : plan.stages) {
    EXPECT_EQ(stage.arms[0].config.robot.mass_kg, 4.0);
    EXPECT_EQ(stage.arms[0].config.robot.speed_mps, 2.0);
    EXPECT_TRUE(stage.arms[0].settings.empty());
  }
}

TEST(OverridesTest, SeedAndMissions) {
  const SweepPlan plan = LoadText(kStudy, {.set = {}, .seed = 77, .missions = {{"", 4}}});
  EXPECT_EQ(plan.seed, 77u);
  EXPECT_EQ(plan.Missions(), 8);
  EXPECT_EQ(Refusal(kStudy, {.set = {}, .seed = {}, .missions = {{"", 0}}}),
            "--missions 0: missions: '0' is not allowed; allowed: 1 .. 10000000");
  EXPECT_EQ(
      Refusal(kStudy, {.set = {}, .seed = {}, .missions = {{"", 9'000'000}}}),
      "--missions 9000000: 18000000 missions in the stages up to 'online' are not allowed; allowed: at most "
      "10000000 in a sweep");
}

TEST(OverridesTest, StandInForMissingMissions) {
  EXPECT_EQ(LoadText("name: x\n", {.set = {}, .seed = {}, .missions = {{"", 4}}}).Missions(), 4);
}

TEST(OverridesTest, MissionsOfOneStage) {
  const char* kStages =
      "name: x\nmissions: 3\nstages:\n  - {name: a}\n  - {name: b}\n  - {name: t, kind: train, after: a}\n";
  const auto counts = [&](std::vector<MissionsOverride> missions) {
    const SweepPlan plan = LoadText(kStages, {.set = {}, .seed = {}, .missions = std::move(missions)});
    return std::pair(plan.stages[0].missions, plan.stages[1].missions);
  };
  EXPECT_EQ(counts({{"b", 40}}), std::pair(3, 40));
  EXPECT_EQ(counts({{"b", 40}, {"", 5}}), std::pair(5, 40));
  EXPECT_EQ(Refusal(kStages, {.set = {}, .seed = {}, .missions = {{"c", 4}}}),
            "--missions c=4: 'c' is not a stage that flies; allowed: a | b");
  EXPECT_EQ(Refusal(kStages, {.set = {}, .seed = {}, .missions = {{"t", 4}}}),
            "--missions t=4: 't' is not a stage that flies; allowed: a | b");
  EXPECT_EQ(Refusal(kStages, {.set = {}, .seed = {}, .missions = {{"b", 4}, {"b", 5}}}),
            "--missions b=5: missions: is said twice, first by --missions b=4");
}

TEST(OverridesTest, RefusalsHaveNoFile) {
  EXPECT_EQ(Refusal(kStudy, Set({"robot.mas_kg=2"})),
            "--set robot.mas_kg=2: robot.mas_kg: unknown key; did you mean robot.mass_kg?");
  EXPECT_EQ(Refusal(kStudy, Set({"robot.mass_kg=-1"})),
            "--set robot.mass_kg=-1: robot.mass_kg: '-1' is not allowed; allowed: 0.05 .. 50 kg");
  EXPECT_EQ(Refusal(kStudy, Set({"robot.mass_kg"})),
            "--set robot.mass_kg: is not allowed; allowed: KEY=VALUE");
  EXPECT_EQ(Refusal(kStudy, Set({""})), "--set : is not allowed; allowed: KEY=VALUE");
  EXPECT_EQ(Refusal(kStudy, Set({"robot.mass_kg=1", "robot.mass_kg=2"})),
            "--set robot.mass_kg=2: robot.mass_kg: is set twice, first by --set robot.mass_kg=1");
  EXPECT_EQ(Refusal(kStudy, Set({"robot.mass_kg=1\n2"})),
            "--set robot.mass_kg=1\\x0a2: robot.mass_kg: '1\\x0a2' is not allowed; allowed: 0.05 .. 50 kg");
  EXPECT_EQ(
      Refusal(kStudy, Set({"agents.eta_int=0.9"})),
      "--set agents.eta_int=0.9: agents.eta_int: '0.9' is not allowed; at most agents.eta_min = 0.75 (arm "
      "'rbs')");
}

TEST(OverridesTest, MayNotSetWhatAnAxisVaries) {
  EXPECT_EQ(
      Refusal(kStudy, Set({"strategy=ed3r"})),
      "--set strategy=ed3r: mission.strategy: is not allowed here: the sweep varies it, at x.yaml:5:20");
}

// It would be lost in these points, without a word.
TEST(OverridesTest, AnAirframeFileMayNotStandInForThoseOfPoints) {
  const ScratchFolder scratch;
  scratch.Write("light.yaml", "robot: {mass_kg: 1.2}\n");
  scratch.Write("heavy.yaml", "robot: {mass_kg: 3}\n");
  const std::string study = scratch.Write("x.yaml",
                                          "name: x\nmissions: 1\nsweep:\n  list: [{name: a}, {name: b, "
                                          "robot.mass_kg: 2}, {name: c, robot: heavy.yaml}]\n");
  const std::string set = "robot=" + scratch.Path() + "/light.yaml";
  try {
    LoadSweep(study, Set({set}));
    FAIL() << "accepted";
  } catch (const UserError& error) {
    EXPECT_EQ(error.what(), "--set " + set + ": robot: is not allowed here: the sweep varies it, at " +
                                study + ":4:67; write the file there");
  }
}

// What the second file does not name is the default again, wherever the two meet.
TEST(OverridesTest, AnAirframeFileReplacesAnEarlierOneWhole) {
  const ScratchFolder scratch;
  scratch.Write("a.yaml", "robot: {mass_kg: 3, width_m: 0.6}\nenergy: {model: momentum}\n");
  const std::string b = scratch.Write("b.yaml", "robot: {height_m: 0.2}\n");
  const std::string alone = scratch.Write("alone.yaml", "name: x\nmissions: 1\nset: {robot: b.yaml}\n");
  const std::string with_a =
      scratch.Write("with_a.yaml", "name: x\nmissions: 1\nset: {robot: a.yaml, robot.speed_mps: 2}\n");
  scratch.Write("bare.yaml", "name: x\nmissions: 1\n");
  const auto expect_b = [](const SweepPlan& plan) {
    const Config& config = plan.stages.back().arms.back().config;
    EXPECT_EQ(config.robot.height_m, 0.2);
    EXPECT_EQ(config.robot.mass_kg, Config().robot.mass_kg);
    EXPECT_EQ(config.robot.width_m, Config().robot.width_m);
    EXPECT_EQ(GetParameter(config, "energy.model"), GetParameter(Config(), "energy.model"));
    EXPECT_EQ(config.robot.speed_mps, 2.0);  // written as a setting
  };
  expect_b(LoadSweep(with_a, Set({"robot=" + b})));
  expect_b(LoadSweep(scratch.Write("c.yaml", "name: x\nbase: with_a.yaml\nset: {robot: b.yaml}\n"), {}));
  expect_b(LoadSweep(
      scratch.Write("d.yaml", "name: x\nbase: with_a.yaml\nstages: [{name: s, set: {robot: b.yaml}}]\n"),
      {}));
  const SweepPlan points = LoadSweep(
      scratch.Write(
          "e.yaml",
          "name: x\nbase: with_a.yaml\nsweep: {list: [{name: own}, {name: mine, robot: b.yaml}]}\n"),
      {});
  EXPECT_EQ(points.stages[0].arms[0].config.robot.mass_kg, 3.0);
  expect_b(points);
}

TEST(OverridesTest, TwoAirframeFilesOfOneLevelAreRefused) {
  const ScratchFolder scratch;
  const std::string a = scratch.Write("a.yaml", "robot: {mass_kg: 3}\n");
  const std::string b = scratch.Write("b.yaml", "robot: {height_m: 0.2}\n");
  const std::string none = scratch.Write("none.yaml", "{}\n");
  const auto refusal = [&](const std::string& text, const SweepOverrides& overrides) {
    try {
      LoadSweep(scratch.Write("x.yaml", text), overrides);
    } catch (const UserError& error) {
      std::string message = error.what();
      const std::string folder = scratch.Path() + "/";
      for (std::size_t at; (at = message.find(folder)) != std::string::npos;)
        message.erase(at, folder.size());
      return message;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal("name: x\nmissions: 1\n", Set({"robot=" + a, "robot=" + b})),
            "--set robot=b.yaml: robot: is set twice, first by --set robot=a.yaml");
  EXPECT_EQ(refusal("name: x\nmissions: 1\n", Set({"robot=" + none})),
            "--set robot=none.yaml: robot: 'none.yaml' sets nothing; allowed: an airframe file with a key at "
            "least");
  EXPECT_EQ(refusal("name: x\nmissions: 1\nsweep: {list: [{name: p}, {name: q, robot: a.yaml}]}\n",
                    Set({"robot=" + b})),
            "--set robot=b.yaml: robot: is not allowed here: the sweep varies it, at x.yaml:3:44; write the "
            "file there");
  EXPECT_EQ(refusal("name: x\nmissions: 1\nsweep: {list: [{name: q, robot: a.yaml}]}\n"
                    "stages: [{name: s, sweep: {list: [{name: r, robot: b.yaml}]}}]\n",
                    {}),
            "x.yaml:4:52: robot: is on another axis, too, at x.yaml:3:33");
  scratch.Write("base.yaml", "name: x\nmissions: 1\nstages: [{name: s, set: {robot: a.yaml}}]\n");
  EXPECT_EQ(refusal("name: x\nbase: base.yaml\nset: {robot: b.yaml}\n", {}),
            "x.yaml:3:14: robot: has no effect: every stage of the base file says its own, at base.yaml:3:10 "
            "first; write the stages anew, or give --set robot=FILE");
}

TEST(OverridesTest, LaterLayersCheckWhatTheyKnow) {
  const ScratchFolder scratch;
  const ValueCheck check = [](const std::string& key, const std::string& value) {
    if (key != "mission.strategy" || value == "rbs" || value == "random") return std::string();
    return key + ": '" + value + "' is not a strategy";
  };
  const std::string good = scratch.Write("good.yaml", kStudy);
  EXPECT_EQ(LoadSweep(good, {}, check).stages[0].arms.size(), 2u);
  const auto refusal = [&](const std::string& text, const SweepOverrides& overrides = {}) {
    try {
      LoadSweep(scratch.Write("x.yaml", text), overrides, check);
    } catch (const UserError& error) {
      return std::string(error.what()).substr(error.what()[0] == '-' ? 0 : scratch.Path().size() + 1);
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal("name: x\nmissions: 1\nsweep: {strategy: [rbs, rsb]}\n"),
            "x.yaml:3:25: mission.strategy: 'rsb' is not a strategy");
  EXPECT_EQ(refusal("name: x\nmissions: 1\nwhere: strategy != rsb\n"),
            "x.yaml:3:8: mission.strategy: 'rsb' is not a strategy");
  EXPECT_EQ(refusal("name: x\nmissions: 1\n", Set({"strategy=rsb"})),
            "--set strategy=rsb: mission.strategy: 'rsb' is not a strategy");
}

}  // namespace
}  // namespace ed3r::sweep
