// Batch scripts without a batch system: sbatch, scontrol and ed3r are small scripts that write down how they were called.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "engine/schedule/batch/shell.h"
#include "engine/schedule/batch/slurm_limits.h"
#include "engine/schedule/batch/slurm_scripts.h"
#include "engine/schedule/batch/steps.h"
#include "engine/schedule/progress_of_stage.h"
#include "tests/sweep/scratch.h"

namespace ed3r::schedule {
namespace {

constexpr char kPlan[] = R"(
name: study
stages:
  - {name: warmup, missions: 30, set: {strategy: random}}
  - {name: training, kind: train, after: warmup}
  - {name: online, after: training, missions: 20, set: {strategy: ed3r}}
)";

constexpr char kPrecisePlan[] = R"(
name: precise
missions: 100
precision: {metric: msr_pct, half_width: 2, every: 40}
sweep: {robot.speed_mps: [3, 4]}
)";

std::vector<BatchStep> StepsFor(const char* plan_text, std::int64_t shards) {
  const sweep::SweepPlan plan = sweep::LoadText(plan_text);
  return StepsOf(plan, shards, 2, std::vector<double>(plan.stages.size(), 0.0));
}

std::vector<std::string> Names(const std::vector<BatchStep>& steps) {
  std::vector<std::string> names;
  for (const BatchStep& step : steps) names.push_back(step.name);
  return names;
}

TEST(BatchStepsTest, FollowTheStages) {
  const std::vector<BatchStep> steps = StepsFor(kPlan, 25);
  EXPECT_EQ(Names(steps),
            (std::vector<std::string>{"1-warmup", "2-warmup-merge", "3-training", "4-training-collect",
                                      "5-online", "6-online-merge", "7-report"}));
  EXPECT_EQ(steps[0].tasks, 25);
  EXPECT_EQ(steps[2].tasks, 2) << "one per network";
  EXPECT_EQ(steps[4].tasks, 20) << "no task without a mission";
  EXPECT_TRUE(steps[1].built_upon);
  EXPECT_FALSE(steps[5].built_upon);
}

TEST(BatchStepsTest, TasksAreWrittenAsArraysWithinTheLimit) {
  EXPECT_EQ(TaskList({2, 5, 6, 7, 9, 10}), "2,5-7,9-10");
  std::vector<std::int64_t> all(2500);
  std::iota(all.begin(), all.end(), 1);
  EXPECT_EQ(ArraysOf(all, 1000), (std::vector<std::string>{"1-1000+0", "1-1000+1000", "1-500+2000"}));
  EXPECT_EQ(ArraysOf({1000, 1001, 2002}, 1000), (std::vector<std::string>{"1000+0", "1+1000", "2+2000"}));
  EXPECT_TRUE(ArraysOf({}, 1000).empty());
}

// man sbatch: minutes, minutes:seconds, hours:minutes:seconds, days-hours, days-hours:minutes, days-hours:minutes:seconds.
TEST(SlurmLimitsTest, AreAsSbatchDocumentsThem) {
  EXPECT_EQ(SlurmTime_s("90"), 90 * 60);
  EXPECT_EQ(SlurmTime_s("90:30"), 90 * 60 + 30);
  EXPECT_EQ(SlurmTime_s("3:00:05"), 3 * 3600 + 5);
  EXPECT_EQ(SlurmTime_s("2-12"), 60 * 3600);
  EXPECT_EQ(SlurmTime_s("2-12:30"), 60 * 3600 + 1800);
  EXPECT_EQ(SlurmTime_s("2-12:30:15"), 60 * 3600 + 1815);
  for (const char* wrong : {"", "3h", "1:2:3:4", "1-", "-3", "1-2-3", "1:", ":30", "1.5", "1-02:03:04:05",
                            " 3", "+3", "99999999999"})
    EXPECT_EQ(SlurmTime_s(wrong), std::nullopt) << wrong;
  for (const char* right : {"1000", "500M", "2G", "1T", "4096K"}) EXPECT_TRUE(IsSlurmMemory(right)) << right;
  for (const char* wrong : {"", "0", "2g", "2GB", "M", "1.5G", "-1G"})
    EXPECT_FALSE(IsSlurmMemory(wrong)) << wrong;
}

TEST(ShellWordTest, IsOneWordWhateverIsInIt) {
  EXPECT_EQ(ShellWord("results/runs/a-b"), "results/runs/a-b");
  EXPECT_EQ(ShellWord("it's $HOME; x"), "'it'\\''s $HOME; x'");
  EXPECT_EQ(ShellWord(""), "''");
  EXPECT_FALSE(IsDirectiveWord("a b"));
  EXPECT_FALSE(IsDirectiveWord("a\n#SBATCH --x"));
}

// The scripts of kPlan in a folder whose name needs quotes, with a PATH on which the batch system is written down.
class SlurmScriptsTest : public testing::Test {
 protected:
  void Write(const char* plan, std::int64_t shards, std::int64_t array_limit) {
    SlurmOptions options;
    options.program = Tool("ed3r", "echo \"ed3r $*\" >>\"$LOG\"; eval \"${ED3R_DOES:-}\"");
    options.sweep = {"/sweeps/study.yaml", "--set", "robot.speed_mps=3"};
    options.working_dir = scratch_.Path();
    options.run_dir = scratch_.Path() + "/a run's";
    options.cache_dir = scratch_.Path() + "/cache";
    options.partition = "long";
    options.time = "01:00:00";
    options.shards = shards;
    options.array_limit = array_limit;
    Tool("sbatch",
         "n=$(cat \"$LOG.n\" 2>/dev/null || echo 0); echo $((n + 1)) >\"$LOG.n\"; echo \"sbatch $*\" "
         ">>\"$LOG\"; "
         "echo $((n + 101))");
    Tool("scontrol", "echo \"scontrol $*\" >>\"$LOG\"");
    for (const BatchFile& file : SlurmScripts("study", StepsFor(plan, shards), options)) {
      const std::string path = scratch_.Write("scripts/" + file.name, file.content);
      if (file.executable) std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    }
  }

  std::string Tool(const std::string& name, const std::string& body) {
    const std::string path = scratch_.Write("bin/" + name, "#!/bin/bash\n" + body + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }

  // Runs a line of shell in the scripts' folder; its exit status. What was called is in Log().
  int Shell(const std::string& line) {
    const std::string log = scratch_.Path() + "/log";
    std::filesystem::remove(log);
    std::filesystem::remove(log + ".n");
    const std::string script =
        scratch_.Write("line.sh", "cd '" + scratch_.Path() + "/scripts'; export PATH='" + scratch_.Path() +
                                      "/bin':$PATH LOG='" + log + "'\n" + line + "\n");
    const int status = std::system(("bash '" + script + "' >'" + scratch_.Path() + "/said' 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string Read(const std::string& name) {
    std::ifstream file(scratch_.Path() + "/" + name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::string Log() { return Read("log"); }

  sweep::ScratchFolder scratch_;
};

TEST_F(SlurmScriptsTest, AreShellThatParses) {
  Write(kPlan, 4, 1000);
  EXPECT_EQ(Shell("for script in *; do [ -d \"$script\" ] || bash -n \"$script\" || exit 1; done"), 0)
      << Read("said");
}

TEST_F(SlurmScriptsTest, AreSubmittedEachAfterTheOneBeforeIt) {
  Write(kPlan, 4, 3);
  ASSERT_EQ(Shell("./submit.sh"), 0) << Read("said");
  EXPECT_EQ(
      Log(),
      "sbatch --parsable --array=1-3 1-warmup.sbatch 0\n"
      "sbatch --parsable --array=1 1-warmup.sbatch 3\n"
      "sbatch --parsable --dependency=afterok:101:102 --kill-on-invalid-dep=yes 2-warmup-merge.sbatch \n"
      "sbatch --parsable --array=1-2 --dependency=afterok:103 --kill-on-invalid-dep=yes 3-training.sbatch 0\n"
      "sbatch --parsable --dependency=afterok:104 --kill-on-invalid-dep=yes 4-training-collect.sbatch \n"
      "sbatch --parsable --array=1-3 --dependency=afterok:105 --kill-on-invalid-dep=yes 5-online.sbatch 0\n"
      "sbatch --parsable --array=1 --dependency=afterok:105 --kill-on-invalid-dep=yes 5-online.sbatch 3\n"
      "sbatch --parsable --dependency=afterok:106:107 --kill-on-invalid-dep=yes 6-online-merge.sbatch \n"
      "sbatch --parsable --dependency=afterok:108 --kill-on-invalid-dep=yes 7-report.sbatch \n");
}

TEST_F(SlurmScriptsTest, BeginAtAStepWithTheTasksThatAreOwed) {
  Write(kPlan, 4, 3);
  ASSERT_EQ(Shell("./submit.sh 5 2+0 1+3"), 0) << Read("said");
  EXPECT_EQ(
      Log(),
      "sbatch --parsable --array=2 5-online.sbatch 0\n"
      "sbatch --parsable --array=1 5-online.sbatch 3\n"
      "sbatch --parsable --dependency=afterok:101:102 --kill-on-invalid-dep=yes 6-online-merge.sbatch \n"
      "sbatch --parsable --dependency=afterok:103 --kill-on-invalid-dep=yes 7-report.sbatch \n");
}

TEST_F(SlurmScriptsTest, ATaskIsAnOrdinaryRunOfOneShard) {
  Write(kPlan, 4, 1000);
  ASSERT_EQ(Shell("SLURM_ARRAY_TASK_ID=2 SLURM_CPUS_PER_TASK=3 bash 1-warmup.sbatch 1"), 0) << Read("said");
  const std::string run = scratch_.Path() + "/a run's";
  EXPECT_EQ(Log(), "ed3r run /sweeps/study.yaml --set robot.speed_mps=3 --stage warmup --shard 3/4 --from " +
                       run + " --out " + run + "/shards/warmup/00003 --cache " + scratch_.Path() +
                       "/cache --threads 3 --quiet\n");
}

TEST_F(SlurmScriptsTest, MemoryIsALineToEdit) {
  Write(kPlan, 4, 1000);
  EXPECT_NE(Read("scripts/1-warmup.sbatch").find("\n##SBATCH --mem=1G"), std::string::npos);
  SlurmOptions options;
  options.memory = "2G";
  const std::vector<BatchFile> files = SlurmScripts("study", StepsFor(kPlan, 4), options);
  EXPECT_EQ(std::count_if(files.begin(), files.end(),
                          [](const BatchFile& file) {
                            return file.content.find("\n#SBATCH --mem=2G\n") != std::string::npos;
                          }),
            7)
      << "every step";
}

TEST_F(SlurmScriptsTest, OnlyATaskThatWasStoppedInTimeOrKilledGoesBack) {
  Write(kPlan, 4, 1000);
  const auto task = [&](const std::string& does, const std::string& before) {
    return Shell(
        "export SLURM_ARRAY_TASK_ID=2 SLURM_JOB_ID=77; " + before + " ED3R_DOES='" + does +
        "' bash 1-warmup.sbatch & task=$!; sleep 0.5; [ -z \"$NOTICE\" ] || kill -$NOTICE $task; wait $task");
  };
  const std::string requeue = "scontrol requeue 77";
  const std::string stops = "trap \"exit 75\" USR1 TERM; while :; do sleep 0.05; done";
  EXPECT_EQ(task(stops, "NOTICE=USR1;"), 75);
  EXPECT_NE(Log().find(requeue), std::string::npos) << "the time limit is near: it asks for another turn";
  EXPECT_EQ(task(stops, "NOTICE=TERM;"), 75);
  EXPECT_EQ(Log().find(requeue), std::string::npos) << "the scheduler knows whether it cancels or preempts";
  EXPECT_EQ(task("kill -9 $$", ""), 75);
  EXPECT_NE(Log().find(requeue), std::string::npos);
  EXPECT_EQ(task("kill -9 $$", "export SLURM_RESTART_COUNT=3;"), 137) << "not for ever";
  EXPECT_EQ(Log().find(requeue), std::string::npos);
  EXPECT_EQ(task("exit 1", ""), 1);
  EXPECT_EQ(task("exit 3", ""), 0) << "failed missions are in the store";
}

TEST_F(SlurmScriptsTest, ARoundOfAPrecisionDecidesWhatFollows) {
  Write(kPrecisePlan, 4, 1000);
  ASSERT_EQ(Shell("./submit.sh"), 0) << Read("said");
  EXPECT_EQ(Log().find("3-report"), std::string::npos) << "nobody knows yet how many rounds there are";
  const std::string status = "case \"$1\" in status) exit ${STATE} ;; esac";
  const auto merge = [&](int state) {
    return Shell("export STATE=" + std::to_string(state) + "; ED3R_DOES='" + status +
                 "' bash 2-online-merge.sbatch");
  };
  EXPECT_EQ(merge(75), 0) << Read("said");
  EXPECT_NE(Log().find("sbatch --parsable --array=1-4 1-online.sbatch 0"), std::string::npos) << Log();
  EXPECT_EQ(merge(0), 0) << Read("said");
  EXPECT_NE(Log().find("sbatch --parsable 3-report.sbatch"), std::string::npos) << Log();
  EXPECT_EQ(merge(3), 3);
  EXPECT_EQ(Log().find("sbatch"), std::string::npos);
}

std::vector<sweep::RunId> Missions(int arms, int count) {
  std::vector<sweep::RunId> ids;
  for (int arm = 0; arm < arms; ++arm)
    for (int mission = 0; mission < count; ++mission) ids.push_back({0, arm, mission});
  return ids;
}

TEST(StageProgressTest, WithoutAPrecisionAllMissionsAreDue) {
  const sweep::SweepPlan plan = sweep::LoadText(kPlan);
  std::vector<sweep::RunId> stored = Missions(1, 30);
  EXPECT_TRUE(ProgressOf(plan, "warmup", stored, "", {}).open.empty());
  stored.erase(stored.begin() + 7);
  const StageProgress progress = ProgressOf(plan, "warmup", stored, "", {});
  EXPECT_EQ(progress.missing, 1);
  EXPECT_TRUE(progress.Asks({0, 0, 7}));
  EXPECT_TRUE(ProgressOf(plan, "training", stored, "", {}).open.empty());
  EXPECT_EQ(ProgressOf(plan, "online", stored, "", {}).missing, 20);
}

TEST(StageProgressTest, APrecisionIsDecidedRoundByRound) {
  const sweep::SweepPlan plan = sweep::LoadText(kPrecisePlan);
  // Arm 0 is known after the first round, arm 1 never.
  const HalfWidthFn half_width = [&](const std::string&, int, const std::string& arm, int,
                                     const std::string&) {
    return arm == plan.stages[0].arms[0].name ? 1.0 : std::nan("");
  };
  const StageProgress first = ProgressOf(plan, "online", {}, "", half_width);
  EXPECT_EQ(first.upto, 40);
  EXPECT_EQ(first.missing, 80);
  const StageProgress second = ProgressOf(plan, "online", Missions(2, 40), "", half_width);
  EXPECT_EQ(second.open, std::vector<int>{1});
  EXPECT_EQ(second.upto, 80);
  EXPECT_FALSE(second.Asks({0, 0, 50}));
  EXPECT_TRUE(second.Asks({0, 1, 50}));
  EXPECT_TRUE(ProgressOf(plan, "online", Missions(2, 100), "", half_width).open.empty());
}

}  // namespace
}  // namespace ed3r::schedule
