#include "engine/sweep/plan_text.h"

#include <gtest/gtest.h>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

// A study with everything that a plan can have.
SweepPlan Study(const ScratchFolder& scratch) {
  scratch.Write("sweeps/worlds/a.yaml", "a");
  return LoadSweep(scratch.Write("sweeps/x.yaml", R"(# Why?
name: x
seed: 18446744073709551615
set: {mission.world: worlds/a.yaml, training.learning_rate: 1e-4}
sweep: {robot.mass_kg: [1.1, 2.3]}
stages:
  - {name: warmup, missions: 40, set: {strategy: random}}
  - {name: training, kind: train, after: warmup}
  - name: online
    after: [warmup, training]
    missions: 300
    precision: {metric: msr_pct, half_width: 1.5, every: 28}
    sweep: {agents.eta_min: [0.65, 0.75]}
    set: {strategy: ed3r}
)"));
}

TEST(PlanTextTest, APlanComesBackFromItsText) {
  const ScratchFolder scratch;
  const SweepPlan plan = Study(scratch);
  const SweepPlan back = PlanOf(ReadPlanText(plan.CanonicalText()), "run");
  EXPECT_EQ(back.CanonicalText(), plan.CanonicalText());
  EXPECT_EQ(back.seed, 18446744073709551615u);
  ASSERT_EQ(back.stages.size(), 3u);
  EXPECT_EQ(back.stages[1].kind, StageKind::kTrain);
  EXPECT_EQ(back.stages[2].after, (std::vector<std::string>{"warmup", "training"}));
  ASSERT_TRUE(back.stages[2].precision);
  EXPECT_EQ(back.stages[2].precision->metric, "msr_pct");
  EXPECT_EQ(back.stages[2].precision->half_width, 1.5);
  EXPECT_EQ(back.stages[2].precision->every, 28);
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    ASSERT_EQ(back.stages[s].arms.size(), plan.stages[s].arms.size());
    for (std::size_t a = 0; a < plan.stages[s].arms.size(); ++a) {
      EXPECT_EQ(back.stages[s].arms[a].variant, plan.stages[s].arms[a].variant);
      EXPECT_EQ(back.stages[s].arms[a].files.at("mission.world"), "worlds/a.yaml");
    }
  }
}

TEST(PlanTextTest, ATextOfAnotherVersionIsReadAsFarAsItGoes) {
  const WrittenPlan plan = ReadPlanText(
      "sweep=s\nseed=1\nnews=2\nstage=a\nkind=fly\nafter=\nmissions=2\nmood=3\narm=x=1\nmission.strategy="
      "rbs\n"
      "robot.colour=red\n");
  ASSERT_EQ(plan.stages.size(), 1u);
  EXPECT_EQ(plan.stages[0].arms[0].name, "x=1");
  EXPECT_EQ(plan.stages[0].arms[0].settings.at("robot.colour"), "red");
  try {
    PlanOf(plan, "run");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("run: arm x=1: robot.colour"), std::string::npos)
        << error.what();
  }
}

TEST(PlanTextTest, ALineThatCannotBeReadIsRefused) {
  for (const char* text :
       {"seed=x\n", "seed=\n", "stage=a\nmissions=1.5\n", "stage=a\nprecision=msr_pct 1.5\n"})
    EXPECT_THROW(ReadPlanText(text), UserError) << text;
  EXPECT_TRUE(ReadPlanText("").stages.empty());
}

}  // namespace
}  // namespace ed3r::sweep
