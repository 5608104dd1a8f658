#include "engine/sweep/sweep_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

using Names = std::vector<std::string>;

TEST(SweepFileTest, SmallestStudy) {
  const SweepPlan plan = LoadText("# How much?   (Table 3)\nname: small\nmissions: 12\n");
  EXPECT_EQ(plan.name, "small");
  EXPECT_EQ(plan.question, "How much?   (Table 3)");
  EXPECT_EQ(plan.seed, 0u);
  ASSERT_EQ(plan.stages.size(), 1u);
  const Stage& stage = plan.stages[0];
  EXPECT_EQ(stage.name, "online");
  EXPECT_EQ(stage.kind, StageKind::kFly);
  EXPECT_TRUE(stage.after.empty());
  EXPECT_EQ(stage.missions, 12);
  EXPECT_EQ(ArmNames(stage), Names{"rbs"});
  EXPECT_TRUE(stage.arms[0].settings.empty());
  EXPECT_EQ(plan.Missions(), 12);
}

TEST(SweepFileTest, QuestionIsTheFirstLinesComment) {
  EXPECT_EQ(LoadText("\n  ## Why? \nname: x\nmissions: 1\n").question, "Why?");
  EXPECT_EQ(LoadText("name: x\n# not here\nmissions: 1\n").question, "");
  EXPECT_EQ(LoadText("\xef\xbb\xbf# ED\xc2\xb3R?\nname: x\nmissions: 1\n").question, "ED\xc2\xb3R?");
}

TEST(SweepFileTest, SeedUsesAll64Bits) {
  EXPECT_EQ(LoadText("name: x\nmissions: 1\nseed: 18446744073709551615\n").seed, 18446744073709551615u);
}

TEST(SweepFileTest, SetTakesDottedAndNestedKeys) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1\n"
      "set:\n  robot.mass_kg: 2\n  robot: {speed_mps: 4.5, battery_v: 14.8}\n  strategy: ed3r\n"
      "  agents: {early_completion: false}\n  mission.sites: known\n");
  const Config& config = plan.stages[0].arms[0].config;
  EXPECT_EQ(config.robot.mass_kg, 2.0);
  EXPECT_EQ(config.robot.speed_mps, 4.5);
  EXPECT_EQ(config.robot.battery_v, 14.8);
  EXPECT_EQ(config.mission.strategy, "ed3r");
  EXPECT_FALSE(config.agents.early_completion);
  EXPECT_EQ(config.mission.sites, SiteSet::kKnown);
  EXPECT_EQ(plan.stages[0].arms[0].name, "ed3r-75");
}

TEST(SweepFileTest, ProductRunsTheFirstAxisSlowest) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 3\nsweep:\n"
      "  robot.mass_kg: [1, 2]\n"
      "  radio.path_loss_exponent: {range: [3.0, 3.4, 0.2]}\n");
  EXPECT_EQ(ArmNames(plan.stages[0]),
            (Names{"rbs,mass_kg=1,path_loss_exponent=3", "rbs,mass_kg=1,path_loss_exponent=3.2",
                   "rbs,mass_kg=1,path_loss_exponent=3.4", "rbs,mass_kg=2,path_loss_exponent=3",
                   "rbs,mass_kg=2,path_loss_exponent=3.2", "rbs,mass_kg=2,path_loss_exponent=3.4"}));
  const Arm& arm = plan.stages[0].arms[4];
  EXPECT_EQ(arm.config.robot.mass_kg, 2.0);
  EXPECT_EQ(arm.config.radio.path_loss_exponent, 3.2);
  EXPECT_EQ(arm.settings, (std::vector<std::pair<std::string, std::string>>{
                              {"robot.mass_kg", "2"}, {"radio.path_loss_exponent", "3.2"}}));
  EXPECT_EQ(plan.Missions(), 18);
}

TEST(SweepFileTest, PaperArmsHaveTheirNames) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 850\n"
      "sweep:\n"
      "  strategy: [random, rbs, ed3r, ablation-1, ablation-4, ecd2r]\n"
      "  agents.eta_min: [0.65, 0.75, 0.85]\n"
      "where: strategy == ed3r or agents.eta_min == 0.75\n");
  EXPECT_EQ(ArmNames(plan.stages[0]),
            (Names{"warmup,eta_min=0.75", "rbs,eta_min=0.75", "ed3r-65", "ed3r-75", "ed3r-85",
                   "ablation-1,eta_min=0.75", "ablation-4,eta_min=0.75", "ecd2r,eta_min=0.75"}));
  const SweepPlan listed = LoadText(
      "name: x\nmissions: 850\n"
      "sweep:\n"
      "  list:\n"
      "    - {strategy: random}\n    - {strategy: rbs}\n    - {strategy: ed3r, agents.eta_min: 0.65}\n"
      "    - {strategy: ed3r, agents.eta_min: 0.29}\n    - {strategy: ed3r, agents.eta_min: 0.705}\n"
      "    - {name: ecd2r, strategy: ecd2r, agents.eta_min: 0.8}\n");
  EXPECT_EQ(ArmNames(listed.stages[0]), (Names{"warmup", "rbs", "ed3r-65", "ed3r-29", "ed3r-70.5", "ecd2r"}));
}

TEST(SweepFileTest, NamedPointsStandForWhatTheySet) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1\nsweep:\n"
      "  list:\n    - {name: light, robot.mass_kg: 1}\n    - {name: heavy, robot.mass_kg: 3}\n"
      "  strategy: [rbs, ed3r]\n"
      "  robot.speed_mps: [5]\n");
  EXPECT_EQ(ArmNames(plan.stages[0]), (Names{"rbs,light,speed_mps=5", "ed3r-75,light,speed_mps=5",
                                             "rbs,heavy,speed_mps=5", "ed3r-75,heavy,speed_mps=5"}));
  const SweepPlan fixed = LoadText(
      "name: x\nmissions: 1\nset: {strategy: ed3r}\nsweep:\n"
      "  list:\n    - {name: light, robot.mass_kg: 1}\n    - {name: heavy, robot.mass_kg: 3}\n");
  EXPECT_EQ(ArmNames(fixed.stages[0]), (Names{"light", "heavy"}));
}

TEST(SweepFileTest, KeysThatEndAlikeAreNamedInFull) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1\nsweep:\n  perception.full.slope: [1]\n  perception.quantized.slope: [2]\n"
      "  robot.mass_kg: [1]\n");
  EXPECT_EQ(ArmNames(plan.stages[0]),
            Names{"rbs,perception.full.slope=1,perception.quantized.slope=2,mass_kg=1"});
}

TEST(SweepFileTest, ZipGoesInLockstep) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1\nsweep:\n"
      "  zip: {robot.mass_kg: [1, 2, 3], robot.battery_mah: {range: [3000, 5000, 1000]}}\n");
  const auto& arms = plan.stages[0].arms;
  ASSERT_EQ(arms.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(arms[i].config.robot.mass_kg, 1.0 + i);
    EXPECT_EQ(arms[i].config.robot.battery_mah, 3000.0 + 1000.0 * i);
  }
  EXPECT_EQ(arms[2].name, "rbs,mass_kg=3,battery_mah=5000");
}

TEST(SweepFileTest, BaseFilesLieUnderneath) {
  const ScratchFolder scratch;
  scratch.Write("common/root.yaml",
                "# Not this question\nname: root\nmissions: 5\nseed: 9\n"
                "set: {robot.mass_kg: 2, robot.speed_mps: 4, agents.eta_min: 0.6}\n"
                "sweep: {strategy: [rbs, ed3r]}\n");
  scratch.Write("middle.yaml", "base: common/root.yaml\nmissions: 6\nset: {robot.speed_mps: 3}\n");
  const SweepPlan plan = LoadSweep(scratch.Write(
      "top.yaml", "# Mine\nname: top\nbase: middle.yaml\nsweep: {agents.eta_min: [0.65, 0.75]}\n"));
  EXPECT_EQ(plan.name, "top");
  EXPECT_EQ(plan.question, "Mine");
  EXPECT_EQ(plan.seed, 9u);
  ASSERT_EQ(plan.stages.size(), 1u);
  EXPECT_EQ(plan.stages[0].missions, 6);
  // The top file's sweep replaces the root's, and its axis the root's fixed value.
  EXPECT_EQ(ArmNames(plan.stages[0]), (Names{"rbs,eta_min=0.65", "rbs,eta_min=0.75"}));
  EXPECT_EQ(plan.stages[0].arms[0].config.robot.mass_kg, 2.0);
  EXPECT_EQ(plan.stages[0].arms[0].config.robot.speed_mps, 3.0);
}

// The examples that the header shows.
TEST(SweepFileTest, DocumentedExamplesLoad) {
  const ScratchFolder scratch;
  scratch.Write("paper_base.yaml", "set: {robot.speed_mps: 5}\n");
  const SweepPlan single = LoadSweep(scratch.Write("a.yaml",
                                                   "# Does the threshold pay?\n"
                                                   "name: thresholds\nbase: paper_base.yaml\nmissions: 850\n"
                                                   "seed: 20260101\nset: {robot.speed_mps: 4}\nsweep:\n"
                                                   "  strategy: [rbs, ed3r]\n"
                                                   "  agents.eta_min: [0.65, 0.75, 0.85]\n"
                                                   "where: [strategy == ed3r or agents.eta_min == 0.75]\n"));
  EXPECT_EQ(ArmNames(single.stages[0]), (Names{"rbs,eta_min=0.75", "ed3r-65", "ed3r-75", "ed3r-85"}));
  const SweepPlan staged = LoadSweep(scratch.Write(
      "b.yaml",
      "name: staged\nmissions: 850\nstages:\n"
      "  - {name: warmup, missions: 2040, set: {strategy: random}}\n"
      "  - {name: training, kind: train, after: warmup}\n"
      "  - {name: online, after: [training], set: {strategy: ed3r}, sweep: {agents.eta_min: [0.65, "
      "0.75]}}\n"));
  EXPECT_EQ(ArmNames(staged.stages[1]), Names{"training"});
  EXPECT_EQ(ArmNames(staged.stages[2]), (Names{"ed3r-65", "ed3r-75"}));
}

TEST(SweepFileTest, ShippedSweepsLoad) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(ED3R_SOURCE_DIR "/sweeps")) {
    if (entry.path().extension() != ".yaml") continue;
    const SweepPlan plan = LoadSweep(entry.path().string());
    EXPECT_EQ(plan.name, entry.path().stem().string());
    EXPECT_TRUE(plan.question.find('?') != std::string::npos) << plan.name << ": a study asks a question";
    ++files;
  }
  EXPECT_GE(files, 3);
  const SweepPlan smoke = LoadSweep(ED3R_SOURCE_DIR "/sweeps/smoke.yaml");
  EXPECT_EQ(ArmNames(smoke.stages[0]), (Names{"warmup", "warmup-ecd2r"}));
  const Names paper = {"ed3r-65",    "ed3r-75",    "ed3r-85", "ablation-1", "ablation-2",
                       "ablation-3", "ablation-4", "ecd2r",   "rbs"};
  EXPECT_EQ(ArmNames(smoke.stages[2]), paper);
  const SweepPlan whole = LoadSweep(ED3R_SOURCE_DIR "/sweeps/paper.yaml");
  EXPECT_EQ(ArmNames(whole.stages[2]), paper);
  EXPECT_EQ(whole.Missions(), 2 * 2040 + 9 * 850);
  EXPECT_EQ(LoadSweep(ED3R_SOURCE_DIR "/sweeps/rbs.yaml").Missions(), 850);
  const SweepPlan warmup = LoadSweep(ED3R_SOURCE_DIR "/sweeps/warmup.yaml");
  EXPECT_EQ(warmup.Missions(), 2040);
  EXPECT_EQ(ArmNames(warmup.stages[0]), Names{"warmup"});
  EXPECT_EQ(warmup.stages[0].arms[0].config.mission.first_scenario, 1000000);
}

TEST(SweepFileTest, LargestPlanThatIsAllowed) {
  const SweepPlan plan = LoadText(
      "name: x\nmissions: 1000\nsweep:\n"
      "  robot.mass_kg: {range: [1, 4.99, 0.04]}\n  robot.speed_mps: {range: [1, 5.99, 0.05]}\n");
  EXPECT_EQ(static_cast<int>(plan.stages[0].arms.size()), kMaxArms);
  EXPECT_EQ(plan.Missions(), kMaxMissions);
}

}  // namespace
}  // namespace ed3r::sweep
