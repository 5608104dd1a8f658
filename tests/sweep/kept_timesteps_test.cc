#include "engine/sweep/kept_timesteps.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <tuple>

#include "engine/core/check.h"
#include "engine/sweep/sweep_file.h"
#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

constexpr char kStudy[] = R"(# Why?
name: x
{}
set: {{strategy: rbs}}
stages:
  - {{name: warmup, missions: 40, set: {{strategy: random}}{}}}
  - {{name: training, kind: train, after: warmup{}}}
  - {{name: online, after: training, missions: 30, set: {{strategy: ed3r}}{}}}
)";

TEST(KeptTimestepsTest, AStageSaysItsOwnOverTheTop) {
  const ScratchFolder scratch;
  const SweepPlan plan =
      LoadText(fmt::format(kStudy, "store: {timesteps: failed}", ", store: {timesteps: all}", "", ""));
  EXPECT_EQ(plan.stages[0].timesteps, KeptTimesteps::kAll);
  EXPECT_EQ(plan.stages[2].timesteps, KeptTimesteps::kFailed);
  EXPECT_EQ(ReadKeptTimesteps(plan.CanonicalText()),
            (std::vector{KeptTimesteps::kAll, KeptTimesteps::kAll, KeptTimesteps::kFailed}));
}

TEST(KeptTimestepsTest, TheDefaultLeavesThePlanAsItWas) {
  const ScratchFolder scratch;
  const std::string without = LoadText(fmt::format(kStudy, "", "", "", "")).CanonicalText();
  EXPECT_EQ(without.find("\ntimesteps="), std::string::npos);
  EXPECT_EQ(LoadText(fmt::format(kStudy, "store: {timesteps: all}", "", "", "")).CanonicalText(), without);
}

TEST(KeptTimestepsTest, ABaseFileIsMergedUnderneath) {
  const ScratchFolder scratch;
  scratch.Write("base.yaml",
                "# Why?\nname: b\nmissions: 3\nstore: {timesteps: none}\nset: {strategy: rbs}\n");
  EXPECT_EQ(LoadSweep(scratch.Write("x.yaml", "# Why?\nname: x\nbase: base.yaml\n")).stages[0].timesteps,
            KeptTimesteps::kNone);
}

TEST(KeptTimestepsTest, WhatNetworksLearnFromIsKept) {
  const ScratchFolder scratch;
  const std::string top = Refusal(fmt::format(kStudy, "store: {timesteps: none}", "", "", ""));
  EXPECT_NE(
      top.find(
          "x.yaml:3:20: store.timesteps: 'none' is not allowed for stage 'warmup': stage 'training' learns"),
      std::string::npos)
      << top;
  const std::string own = Refusal(fmt::format(kStudy, "", ", store: {timesteps: failed}", "", ""));
  EXPECT_NE(own.find("store.timesteps: 'failed' is not allowed for stage 'warmup'"), std::string::npos)
      << own;
}

TEST(KeptTimestepsTest, MistakesAreTold) {
  const ScratchFolder scratch;
  for (const auto& [top, training, told] :
       {std::tuple{"store: {timesteps: some}", "",
                   "store.timesteps: 'some' is not allowed; allowed: all | failed | none"},
        std::tuple{"store: {}", "", "store: needs timesteps"},
        std::tuple{"store: {timestep: all}", "", "did you mean timesteps?"},
        std::tuple{"", ", store: {timesteps: all}", "store: is not allowed in a stage of kind train"}}) {
    const std::string refusal = Refusal(fmt::format(kStudy, top, "", training, ""));
    EXPECT_NE(refusal.find(told), std::string::npos) << top << ": " << refusal;
  }
}

}  // namespace
}  // namespace ed3r::sweep
