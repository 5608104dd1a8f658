// A sweep in the pieces that a batch system flies, without one: the commands of the batch scripts, by hand.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/pieces.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

TEST_F(PiecesTest, GiveTheDigestOfOneMachine) {
  const std::string sweep = Write(kStages);
  const std::string whole = (scratch_ / "whole").string();
  ExpectDone(
      Ed3r(fmt::format("run {} --quiet --out {} --cache {}", sweep, whole, (scratch_ / "other").string())));
  ExpectDone(Ed3r(fmt::format("slurm {} --shards 2 --out {} --cache {}", sweep, Run(), Cache())));

  EXPECT_TRUE(Says(Missing(sweep), "step 1-warmup on, 2 of its 2 tasks: 1-2 (12 missions owed)"))
      << Missing(sweep);
  ExpectDone(Piece(sweep, "warmup", "2/2"));
  EXPECT_TRUE(Says(Missing(sweep), "1 of its 2 tasks: 1 (6 missions owed)")) << Missing(sweep);
  const CommandResult status = Ed3r("status --json " + Run());
  EXPECT_EQ(nlohmann::json::parse(status.out)["arms"][0]["done"], 6) << "shards count before they are merged";

  const CommandResult early = Piece(sweep, "training", "1/2");
  EXPECT_EQ(early.status, 2);
  EXPECT_EQ(Ed3r("status --stage warmup " + Run()).status, 3);
  ExpectDone(Piece(sweep, "warmup", "1/2"));
  EXPECT_TRUE(Says(Missing(sweep), "step 2-warmup-merge on\n")) << Missing(sweep);
  EXPECT_EQ(Ed3r("status --stage warmup " + Run()).status, 0) << "shards count before they are merged";
  EXPECT_FALSE(fs::exists(Run() + "/results.sqlite")) << "looking merges nothing";
  Merge("warmup");
  EXPECT_EQ(Ed3r("status --stage warmup " + Run()).status, 0);
  EXPECT_EQ(Ed3r("status --stage online " + Run()).status, 3);
  const CommandResult untrained = Ed3r("status --stage training " + Run());
  EXPECT_EQ(untrained.status, 3);
  EXPECT_EQ(untrained.out, "stage training: not trained, networks of 1 arm are missing\n");

  EXPECT_TRUE(Says(Missing(sweep), "step 3-training on, 2 of its 2 tasks: 1-2")) << Missing(sweep);
  EXPECT_EQ(Piece(sweep, "online", "1/2").status, 2) << "no networks yet";
  EXPECT_FALSE(fs::exists(Run() + "/shards/online")) << "what is refused leaves nothing";
  ExpectDone(Piece(sweep, "training", "1/2"));
  EXPECT_TRUE(Says(Missing(sweep), "step 3-training on, 1 of its 2 tasks: 2")) << Missing(sweep);
  ExpectDone(Piece(sweep, "training", "2/2"));
  EXPECT_TRUE(Says(Missing(sweep), "step 4-training-collect on")) << Missing(sweep);
  EXPECT_EQ(Ed3r("status --stage training " + Run()).status, 3) << "in the cache alone";
  ExpectDone(Ed3r(fmt::format("run {} --stage training --out {} --cache {} --quiet", sweep, Run(), Cache())));
  EXPECT_EQ(Ed3r("status --stage training " + Run()).out, "stage training: finished\n");

  ExpectDone(Piece(sweep, "online", "1/2"));
  const CommandResult of_part = Ed3r("digest " + Run());
  EXPECT_TRUE(Says(of_part.err, "note: this is the digest of ")) << of_part.err;
  EXPECT_NE(of_part.out, Ed3r("digest " + whole).out);
  EXPECT_EQ(Ed3r("status --stage online " + Run()).status, 3);
  ExpectDone(Piece(sweep, "online", "2/2"));
  const CommandResult of_all = Ed3r("digest " + Run());
  EXPECT_EQ(of_all.out, Ed3r("digest " + whole).out) << "shards count before they are merged";
  EXPECT_EQ(of_all.err, "");
  EXPECT_EQ(Ed3r("status --stage online " + Run()).status, 0);
  const std::string report =
      " --json --no-figures --no-missions --force --out " + (scratch_ / "report").string();
  const CommandResult of_shards = Ed3r("report " + Run() + report);
  ExpectDone(of_shards);
  EXPECT_EQ(nlohmann::json::parse(of_shards.out)["arms"]["ed3r-75"]["missions"], 5)
      << "shards count before they are merged";
  const CommandResult of_whole = Ed3r("report " + whole + report);
  EXPECT_EQ(nlohmann::json::parse(of_shards.out)["arms"], nlohmann::json::parse(of_whole.out)["arms"]);
  Merge("online");
  EXPECT_EQ(Ed3r("digest " + Run()).out, Ed3r("digest " + whole).out);
  EXPECT_TRUE(Says(Missing(sweep), "step 7-report on")) << Missing(sweep);
  ExpectDone(Ed3r("report --no-figures " + Run()));
  EXPECT_TRUE(Says(Missing(sweep), "nothing is owed")) << Missing(sweep);
  Merge("online");
  EXPECT_EQ(Ed3r("digest " + Run()).out, Ed3r("digest " + whole).out) << "merging again changes nothing";
}

TEST_F(PiecesTest, EachTrainingOwesTheNetworksOfItsOwnLearners) {
  const std::string sweep =
      Write("name: both\nseed: 3\nmissions: 6\nset: {training.epochs: 2, training.batch: 32, " + kWorld + R"(}
stages:
  - {name: wa, set: {strategy: random}}
  - {name: ta, kind: train, after: wa}
  - {name: oa, after: ta, set: {strategy: ed3r}}
  - {name: wb, after: oa, set: {strategy: random-offload}}
  - {name: tb, kind: train, after: wb}
  - {name: ob, after: tb, set: {strategy: ecd2r}}
)");
  ExpectDone(Ed3r(fmt::format("slurm {} --shards 2 --out {} --cache {}", sweep, Run(), Cache())));
  const auto fly = [&](const std::string& stage) {
    ExpectDone(
        Ed3r(fmt::format("run {} --stage {} --out {} --cache {} --quiet", sweep, stage, Run(), Cache())));
  };
  fly("wa");
  EXPECT_TRUE(Says(Missing(sweep), "step 3-ta on, 2 of its 3 tasks: 1,3")) << Missing(sweep);
  ExpectDone(Piece(sweep, "ta", "3/3"));
  EXPECT_TRUE(Says(Missing(sweep), "step 3-ta on, 1 of its 3 tasks: 1")) << Missing(sweep);
  ExpectDone(Piece(sweep, "ta", "1/3"));
  EXPECT_TRUE(Says(Missing(sweep), "step 4-ta-collect on\n")) << Missing(sweep);
  for (const char* stage : {"ta", "oa", "wb"}) fly(stage);
  EXPECT_TRUE(Says(Missing(sweep), "step 9-tb on, 1 of its 3 tasks: 3")) << Missing(sweep);
  EXPECT_EQ(Ed3r("status --stage ta " + Run()).status, 0);
  EXPECT_EQ(Ed3r("status --stage tb " + Run()).status, 3);
  fly("tb");
  EXPECT_TRUE(Says(Missing(sweep), "step 11-ob on, 2 of its 2 tasks: 1-2")) << Missing(sweep);
}

// The C library of a processor without fused multiply-add is other code.
TEST_F(PiecesTest, WhatIsBuiltOnOtherCodeSaysSo) {
  const std::string other = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F";
  const std::string sweep = Write(kStages), aside = (scratch_ / "aside").string();
  for (const char* stage : {"warmup", "training"})
    ExpectDone(Ed3r(
        fmt::format("run {} --stage {} --out {} --cache {} --quiet", sweep, stage, Run(), Cache()), other));
  if (Ed3r(fmt::format("run {} --stage training --out {} --cache {} --quiet", sweep, Run(), Cache()))
          .status == 0)
    GTEST_SKIP() << "this processor has no other library";
  for (const auto& [stage, shard] : {std::pair("online", "1/1"), std::pair("training", "1/2")}) {
    const CommandResult refused = Piece(sweep, stage, shard);
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(Says(refused.err, Run() + ": holds results of another recipe: the C library, which rounds "))
        << refused.err;
    EXPECT_TRUE(
        Says(refused.err, "; give another --from, or --accept-mixed to build on what other code has made\n"))
        << refused.err;
    ExpectDone(Piece(sweep, stage, std::string(shard) + " --accept-mixed"));
  }
  // Networks alone carry it on, too.
  const std::string into = fmt::format("run {} --cache {} --quiet --out {}", sweep, Cache(), aside);
  ExpectDone(Ed3r(fmt::format("{}/t --stage training --from {} --accept-mixed", into, Run())));
  ExpectDone(Ed3r(fmt::format("{}/q --stage online --from {}/t", into, aside)));
  for (const std::string& dir : {Run() + "/shards/online/1", aside + "/t", aside + "/q"})
    EXPECT_TRUE(
        Says(Ed3r("report --no-figures --no-missions " + dir).out, "pieces, MIXED CODE (--accept-mixed): "))
        << dir;
}

// A task on a node's own disk is killed with most of what it has stored still in the journal beside its file.
TEST_F(PiecesTest, WhatAKilledTaskHasStoredComesHomeFromItsOwnDisk) {
  const std::string sweep = Write(kStages);
  const std::filesystem::path local = scratch_ / "local";
  std::filesystem::create_directory(local);
  ExpectDone(Ed3r(fmt::format("slurm {} --missions warmup=4000 --shards 2 --scratch {} --out {} --cache {}",
                              sweep, local.string(), Run(), Cache())));
  const std::string script = (scratch_ / "kill.sh").string();
  std::ofstream(script) << fmt::format(R"(cd {}/slurm
SLURM_ARRAY_TASK_ID=1 bash 1-warmup.sbatch >../log 2>&1 &
task=$!
for i in $(seq 600); do
  sleep 0.1
  size=$(cat {}/*/results.sqlite-wal 2>/dev/null | wc -c)
  [ "$size" -lt 1500000 ] || break
done
pkill -KILL -P $task
wait $task
)",
                                       Run(), local.string());
  EXPECT_EQ(std::system(("bash " + script).c_str()) >> 8, 75) << ReadAll(scratch_ / "run/log");
  const std::string store = Run() + "/shards/warmup/00001";
  EXPECT_EQ(Ed3r("verify " + store).status, 0);
  const auto status = nlohmann::json::parse(Ed3r("status --json " + store).out);
  EXPECT_GT(status["arms"][0]["done"], 0) << ReadAll(scratch_ / "run/log");
  EXPECT_TRUE(std::filesystem::is_empty(local));
}

TEST_F(PiecesTest, ATaskWithoutItsOwnDiskSaysSo) {
  const std::string sweep = Write("name: once\nmissions: 2\nset: {strategy: rbs, " + kWorld + "}");
  const std::string none = (scratch_ / "none").string(), store = Run() + "/shards/online/00001",
                    log = (scratch_ / "log").string();
  const std::string task =
      fmt::format("cd {}/slurm; SLURM_ARRAY_TASK_ID=1 bash 1-online.sbatch >{} 2>&1", Run(), log);
  ExpectDone(Ed3r(fmt::format("slurm {} --shards 1 --out {}", sweep, Run())));
  EXPECT_EQ(std::system(task.c_str()) >> 8, 0);
  ExpectDone(Ed3r(fmt::format("slurm {} --shards 1 --scratch {} --out {} --force", sweep, none, Run())));
  EXPECT_EQ(std::system(task.c_str()) >> 8, 2);
  const std::string said = ReadAll(log);
  EXPECT_TRUE(Says(said, "no folder can be made in " + none + " on ")) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_EQ(Ed3r("verify " + store).out, store + ": 2 missions whole\n");
}

// A node stops answering, the task is flown by another one, and then the first brings its part home.
TEST_F(PiecesTest, ALateCopyOfATaskTakesNothingAway) {
  const std::string sweep = Write("name: twice\nmissions: 8\nset: {strategy: rbs, " + kWorld + "}");
  const fs::path local = scratch_ / "local";
  fs::create_directory(local);
  ExpectDone(Ed3r(fmt::format("slurm {} --shards 1 --scratch {} --out {}", sweep, local.string(), Run())));
  const std::string store = Run() + "/shards/online/00001", part = (scratch_ / "part").string();
  ExpectDone(Ed3r(fmt::format("run {} --shard 1/2 --quiet --out {}", sweep, part)));
  const std::string late = (scratch_ / "late.sh").string(), script = (scratch_ / "task.sh").string();
  // Flies a half into the folder after --out, while the other copy brings all of it home.
  std::ofstream(late) << fmt::format(R"(#!/bin/bash
[ "$1" = run ] || exec {0} "$@"
while [ "$1" != --out ]; do shift; done
{0} run {1} --stage online --shard 1/1 --quiet --out {2}
cp {3}/results.sqlite "$2"
exit 75
)",
                                     ED3R_BINARY, sweep, store, part);
  std::ofstream(script) << fmt::format(
      "chmod +x {0}; cd {1}/slurm; sed -i 's#^ed3r=.*#ed3r={0}#' common.sh; SLURM_ARRAY_TASK_ID=1 bash "
      "1-online.sbatch\n",
      late, Run());
  EXPECT_EQ(std::system(("bash " + script + " >" + (scratch_ / "log").string() + " 2>&1").c_str()) >> 8, 75)
      << ReadAll(scratch_ / "log");
  EXPECT_EQ(Ed3r("verify " + store).out, store + ": 8 missions whole\n") << ReadAll(scratch_ / "log");
  EXPECT_TRUE(fs::is_empty(local));
}

TEST_F(PiecesTest, APrecisionGoesInRounds) {
  const std::string sweep = Write(
      "name: rounds\nmissions: 60\nprecision: {metric: total_energy_kj, half_width: 2, every: 20}\n"
      "set: {strategy: rbs, " +
      kWorld + "}\nsweep: {robot.battery_mah: [400, 3500]}");
  const std::string whole = (scratch_ / "whole").string();
  ExpectDone(Ed3r(fmt::format("run {} --quiet --out {}", sweep, whole)));
  int rounds = 0;
  for (int status = 75; status == 75 && rounds < 4; ++rounds) {
    for (const char* shard : {"1/3", "2/3", "3/3"}) ExpectDone(Piece(sweep, "online", shard));
    Merge("online");
    status = Ed3r("status --stage online " + Run()).status;
    EXPECT_TRUE(status == 75 || status == 0) << status;
  }
  EXPECT_EQ(rounds, 3) << "the large battery is flown out";
  EXPECT_EQ(Ed3r("digest " + Run()).out, Ed3r("digest " + whole).out);
}

TEST_F(PiecesTest, APartTellsWhatItDidAndWhatToDoNext) {
  const std::string sweep = Write("name: parts\nmissions: 20\nset: {strategy: rbs, " + kWorld +
                                  "}\nsweep: {robot.battery_mah: [400, 800]}");
  const std::string task = Run() + "/shards/online/2";
  const CommandResult of_task = Ed3r(fmt::format("run {} --stage online --shard 2/4 --out {}", sweep, task));
  ExpectDone(of_task);
  EXPECT_TRUE(Says(of_task.out, "part 2 of 4\n")) << of_task.out;
  std::size_t arms = 0, at = 0;
  for (; (at = of_task.out.find("        5        5        0        0\n", at)) != std::string::npos; ++at)
    ++arms;
  EXPECT_EQ(arms, 2u) << "its part, done, failed, missing: " << of_task.out;
  EXPECT_TRUE(Says(of_task.out, task + ": 10 missions stored")) << of_task.out;
  EXPECT_TRUE(Says(of_task.out,
                   fmt::format("all 4 parts are flown: ed3r merge {} {}/shards/online/*/\n", Run(), Run())))
      << of_task.out;
  EXPECT_FALSE(Says(of_task.out, "success")) << "no table of the whole study";
  const std::string alone = (scratch_ / "alone").string();
  const CommandResult of_folder = Ed3r(fmt::format("run {} --shard 4/4 --out {}", sweep, alone));
  EXPECT_TRUE(Says(of_folder.out, "ed3r merge OUT " + alone + " DIR...\n")) << of_folder.out;
}

TEST_F(PiecesTest, APlanTellsHowFarShardsEndApart) {
  const std::string sweep = Write("name: spread\nmissions: 3920\nset: {strategy: rbs, " + kWorld + "}\n");
  const CommandResult planned = Ed3r("plan --json --shards 50 " + sweep);
  ExpectDone(planned);
  const auto shards = nlohmann::json::parse(planned.out)["stages"][0]["shards"];
  EXPECT_EQ(shards["tasks"], 50);
  EXPECT_NEAR(shards["missions"], 78.4, 1e-9);
  EXPECT_NEAR(shards["longest_over_mean"], 1.39, 0.05) << "results/scale.md";
  EXPECT_TRUE(Says(Ed3r("plan --shards 50 " + sweep).out, "in 50 shards: 78 missions and about "));
  const auto few =
      nlohmann::json::parse(Ed3r("plan --json --shards 9000 " + sweep).out)["stages"][0]["shards"];
  EXPECT_EQ(few["tasks"], 3920) << "no task without a mission";
  EXPECT_FALSE(nlohmann::json::parse(Ed3r("plan --json " + sweep).out)["stages"][0].contains("shards"));
}

TEST_F(PiecesTest, WhatCannotBeIsRefused) {
  const std::string sweep = Write(kStages);
  const auto refusal = [&](const std::string& command) {
    const CommandResult result = Ed3r(command);
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  const std::string out = " --out " + Run();
  EXPECT_TRUE(Says(refusal("run " + sweep + out + " --stage onlin"), "no stage 'onlin'"));
  EXPECT_TRUE(Says(refusal("slurm " + sweep + out + " --missing"), "no batch scripts in it"));
  EXPECT_TRUE(
      Says(refusal("slurm " + sweep + out + " --partition 'a b'"), "--partition: 'a b' is not allowed"));
  EXPECT_TRUE(
      Says(refusal("slurm " + sweep + out + " --time 3h"), "--time: '3h' is not allowed; allowed: minutes,"));
  EXPECT_TRUE(Says(refusal("slurm " + sweep + out + " --time 2:00"), "give 4 minutes or more"));
  EXPECT_TRUE(Says(refusal("slurm " + sweep + out + " --mem 2GB"), "--mem: '2GB' is not allowed"));
  EXPECT_FALSE(fs::exists(Run()));
  EXPECT_EQ(Ed3r("slurm " + sweep + " --time 1-0 --mem 2G --out " + (scratch_ / "limited").string()).err, "");
  EXPECT_TRUE(Says(Ed3r("slurm " + sweep + out).err, "note: without --time"));
  ExpectDone(Ed3r("slurm " + sweep + out));
  std::ofstream(Run() + "/slurm/common.sh", std::ios::app) << "module load gcc\n";
  EXPECT_TRUE(Says(refusal("slurm " + sweep + out), "common.sh: differs from what these options give"));
  ExpectDone(Ed3r("slurm " + sweep + out + " --force"));
}

}  // namespace
}  // namespace ed3r::app
