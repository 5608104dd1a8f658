#include <gtest/gtest.h>

#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

using Names = std::vector<std::string>;

constexpr const char* kStudy =
    "name: x\n"
    "missions: 850\n"
    "set: {robot.mass_kg: 2, agents.eta_min: 0.7}\n"
    "stages:\n"
    "  - {name: warmup, missions: 2040, set: {strategy: random, robot.mass_kg: 1.5}}\n"
    "  - {name: training, kind: train, after: warmup}\n"
    "  - name: online\n"
    "    after: [warmup, training]\n"
    "    sweep: {strategy: [rbs, ed3r], agents.eta_min: [0.65, 0.75]}\n"
    "    where: strategy == ed3r or agents.eta_min == 0.75\n";

TEST(StagesTest, EachAddsToTheTopLevel) {
  const SweepPlan plan = LoadText(kStudy);
  ASSERT_EQ(plan.stages.size(), 3u);
  const auto& [warmup, training, online] = std::tie(plan.stages[0], plan.stages[1], plan.stages[2]);
  EXPECT_EQ(warmup.missions, 2040);
  EXPECT_EQ(ArmNames(warmup), Names{"warmup"});
  EXPECT_EQ(warmup.arms[0].config.robot.mass_kg, 1.5);
  EXPECT_EQ(warmup.arms[0].config.agents.eta_min, 0.7);
  EXPECT_EQ(training.kind, StageKind::kTrain);
  EXPECT_EQ(training.missions, 0);
  EXPECT_EQ(training.after, Names{"warmup"});
  EXPECT_EQ(ArmNames(training), Names{"training"});
  EXPECT_EQ(training.arms[0].config.robot.mass_kg, 2.0);
  EXPECT_EQ(online.after, (Names{"warmup", "training"}));
  EXPECT_EQ(online.missions, 850);
  EXPECT_EQ(ArmNames(online), (Names{"rbs,eta_min=0.75", "ed3r-65", "ed3r-75"}));
  EXPECT_EQ(plan.Missions(), 2040 + 3 * 850);
}

TEST(StagesTest, TopLevelAxesAndConditionsHoldInEveryStage) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1\nsweep: {robot.mass_kg: [1, 2, 3]}\nwhere: robot.mass_kg != 2\n"
      "stages:\n"
      "  - {name: a}\n"
      "  - {name: b, sweep: {strategy: [rbs, random]}, where: [strategy == rbs or robot.mass_kg < 3]}\n");
  EXPECT_EQ(ArmNames(plan.stages[0]), (Names{"rbs@mass_kg=1", "rbs@mass_kg=3"}));
  EXPECT_EQ(ArmNames(plan.stages[1]), (Names{"rbs@mass_kg=1", "warmup@mass_kg=1", "rbs@mass_kg=3"}));
  EXPECT_EQ(plan.stages[1].arms[1].variant, "mass_kg=1");
  EXPECT_EQ(plan.stages[1].arms[2].variant, "mass_kg=3");
}

TEST(StagesTest, NamedVariantsNameTheirArms) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1\nsweep: {list: [{name: base}, {name: climb, energy.vertical_form: climb}]}\n"
      "stages:\n  - {name: a}\n  - {name: b, sweep: {strategy: [rbs, ed3r]}}\n");
  EXPECT_EQ(ArmNames(plan.stages[0]), (Names{"rbs@base", "rbs@climb"}));
  EXPECT_EQ(ArmNames(plan.stages[1]), (Names{"rbs@base", "ed3r-75@base", "rbs@climb", "ed3r-75@climb"}));
  EXPECT_EQ(LoadText("name: x\nmissions: 1\nsweep: {robot.mass_kg: [1, 2]}\n").stages[0].arms[0].variant, "");
}

TEST(StagesTest, AnAirframesKeysCanBeSwept) {
  const ScratchFolder scratch;
  scratch.Write("drone.yaml", "robot: {mass_kg: 3.7, speed_mps: 7}\nenergy: {induced_factor: 1.4}\n");
  const auto check = [](const SweepPlan& plan) {
    ASSERT_EQ(plan.stages[0].arms.size(), 2u);
    EXPECT_EQ(plan.stages[0].arms[0].config.robot.mass_kg, 4.0);
    EXPECT_EQ(plan.stages[0].arms[1].config.robot.mass_kg, 5.0);
    EXPECT_EQ(plan.stages[0].arms[1].config.robot.speed_mps, 7.0) << "all else is the file's";
  };
  check(LoadSweep(scratch.Write(
      "x.yaml", "name: x\nmissions: 1\nset: {robot: drone.yaml}\nsweep: {robot.mass_kg: [4, 5]}\n")));
  check(LoadSweep(scratch.Write("s.yaml",
                                "name: x\nmissions: 1\nset: {robot: drone.yaml}\n"
                                "stages:\n  - {name: a, sweep: {robot.mass_kg: [4, 5]}}\n")));
  const std::string axis =
      scratch.Write("axis.yaml", "name: x\nmissions: 1\nsweep: {robot.mass_kg: [4, 5]}\n");
  check(LoadSweep(axis, {.set = {"robot=" + scratch.Path() + "/drone.yaml"}, .seed = {}, .missions = {}}));
  // What somebody wrote beside the axis stays a contradiction.
  EXPECT_THROW(LoadSweep(scratch.Write("y.yaml",
                                       "name: x\nmissions: 1\nset: {robot.mass_kg: 3}\n"
                                       "sweep: {robot.mass_kg: [4, 5]}\n")),
               UserError);
}

// It would be lost: networks learn with what the arms say that ask them.
TEST(StagesTest, ATrainingStageSaysNothingOfItsOwn) {
  for (const auto& [says, what] :
       {std::pair("set: {training.epochs: 3}", "set: is not allowed in stage 't'"),
        std::pair("sweep: {training.learning_rate: [1e-3, 1e-4]}", "sweep: is not allowed"),
        std::pair("where: training.epochs < 5", "where: is not allowed")}) {
    SCOPED_TRACE(says);
    const std::string refusal = Refusal(
        std::string("name: x\nmissions: 3\nstages:\n  - {name: a}\n  - {name: t, kind: train, after: a, ") +
        says + "}\n  - {name: b, after: t}\n");
    EXPECT_NE(refusal.find(what), std::string::npos) << refusal;
  }
}

TEST(StagesTest, WhatEveryStageOfTheBaseSaysOtherwiseIsRefusedAboveIt) {
  const ScratchFolder scratch;
  scratch.Write("base.yaml",
                "name: base\nstages:\n  - {name: s, missions: 3, set: {robot.mass_kg: 2.2}}\n"
                "  - {name: r, missions: 4, set: {robot.mass_kg: 2.5, strategy: rbs}}\n");
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      LoadSweep(scratch.Write("x.yaml", "name: x\nbase: base.yaml\n" + text), {});
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("set: {robot.mass_kg: 3}\n").find("robot.mass_kg: has no effect"), std::string::npos);
  EXPECT_NE(refusal("missions: 8\n").find("missions: has no effect"), std::string::npos);
  EXPECT_EQ(refusal("set: {strategy: random}\n"), "") << "one stage takes it";
}

// What stands above a list holds in the points that do not name its key, too.
TEST(StagesTest, ASettingAboveAListHoldsWhereAPointSaysNothing) {
  const SweepPlan plan = LoadText(
      "name: st\nmissions: 4\nset: {strategy: rbs, robot.battery_mah: 300, robot.mass_kg: 2.4}\n"
      "stages:\n  - name: online\n    sweep:\n      list:\n"
      "        - {name: plain, robot.speed_mps: 5}\n        - {name: light, robot.mass_kg: 1.5}\n");
  ASSERT_EQ(plan.stages[0].arms.size(), 2u);
  EXPECT_EQ(plan.stages[0].arms[0].config.robot.mass_kg, 2.4);
  EXPECT_EQ(plan.stages[0].arms[0].config.robot.speed_mps, 5.0);
  EXPECT_EQ(plan.stages[0].arms[1].config.robot.mass_kg, 1.5);
}

TEST(StagesTest, ABaseFilesSettingHoldsWhereAPointSaysNothing) {
  const ScratchFolder scratch;
  scratch.Write("base.yaml", "name: base\nmissions: 4\nset: {strategy: rbs, robot.mass_kg: 2}\n");
  const SweepPlan plan = LoadSweep(
      scratch.Write("x.yaml",
                    "name: x\nbase: base.yaml\nsweep:\n  list:\n    - {name: plain, robot.speed_mps: 5}\n"
                    "    - {name: light, robot.mass_kg: 1.5}\n"),
      {});
  EXPECT_EQ(plan.stages[0].arms[0].config.robot.mass_kg, 2.0);
  EXPECT_EQ(plan.stages[0].arms[1].config.robot.mass_kg, 1.5);
}

TEST(StagesTest, AnAirframesValueHoldsWhereAPointSaysNothing) {
  const ScratchFolder scratch;
  scratch.Write("air.yaml", "robot: {battery_mah: 4500}\n");
  const std::string points =
      "sweep:\n  list:\n    - {name: plain, robot.speed_mps: 5}\n    - {name: small, robot.battery_mah: "
      "300}\n";
  const std::string head = "name: x\nmissions: 4\n";
  const SweepPlan in_file =
      LoadSweep(scratch.Write("x.yaml", head + "set: {strategy: rbs, robot: air.yaml}\n" + points), {});
  EXPECT_EQ(in_file.stages[0].arms[0].config.robot.battery_mah, 4500.0);
  EXPECT_EQ(in_file.stages[0].arms[1].config.robot.battery_mah, 300.0);
}

TEST(StagesTest, ContradictionsAcrossLevelsAreRefused) {
  EXPECT_EQ(Refusal("name: x\nmissions: 1\nsweep: {robot.mass_kg: [1, 2]}\n"
                    "stages:\n  - {name: a, set: {robot.mass_kg: 1}}\n"),
            "x.yaml:5:36: robot.mass_kg: '1' is not allowed here: the sweep varies it, at x.yaml:3:25");
  EXPECT_EQ(Refusal("name: x\nmissions: 1\nsweep: {robot.mass_kg: [1, 2]}\n"
                    "stages:\n  - {name: a, sweep: {robot.mass_kg: [1]}}\n"),
            "x.yaml:5:39: robot.mass_kg: is on another axis, too, at x.yaml:3:25");
}

TEST(StagesTest, MissionsOverrideLeavesTrainingAlone) {
  const SweepPlan plan = LoadText(kStudy, {.set = {}, .seed = {}, .missions = {{"", 3}}});
  EXPECT_EQ(plan.stages[0].missions, 3);
  EXPECT_EQ(plan.stages[1].missions, 0);
  EXPECT_EQ(plan.stages[2].missions, 3);
  EXPECT_EQ(plan.Missions(), 12);
}

TEST(StagesTest, LimitsCountAllStages) {
  EXPECT_EQ(
      Refusal("name: x\nmissions: 6000000\nstages:\n  - {name: a}\n  - {name: b}\n"),
      "x.yaml:2:11: 12000000 missions in the stages up to 'b' are not allowed; allowed: at most 10000000 "
      "in a sweep");
  EXPECT_EQ(Refusal("name: x\nmissions: 1\nsweep: {robot.battery_mah: {range: [1000, 7000, 1]}}\n"
                    "stages:\n  - {name: a}\n  - {name: b}\n"),
            "x.yaml:3:9: 6001 combinations in stage 'b', after 6001 arms, are not allowed; allowed: at most "
            "10000 arms in a sweep");
}

}  // namespace
}  // namespace ed3r::sweep
