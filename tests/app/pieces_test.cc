// Parts of a run that are not merged, of plans that have grown or are another's, and batch scripts of another sweep or folder.
#include "tests/app/pieces.h"

#include <nlohmann/json.hpp>

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

// Half merged: every command that reads results reads the rest, too.
TEST_F(PiecesTest, PartsThatAreNotMergedCountEverywhere) {
  const std::string sweep = Write("name: half\nmissions: 4\nset: {strategy: rbs, " + kWorld + "}");
  const std::string whole = (scratch_ / "whole").string();
  ExpectDone(Ed3r(fmt::format("run {} --quiet --out {}", sweep, whole)));
  for (const char* shard : {"1/2", "2/2"}) ExpectDone(Piece(sweep, "online", shard));
  ExpectDone(Ed3r(fmt::format("merge {0} {0}/shards/online/1", Run())));
  const CommandResult exported = Ed3r("export --csv " + Run());
  ExpectDone(exported);
  EXPECT_EQ(exported.err, "");
  ExpectDone(Ed3r("export --csv " + whole));
  EXPECT_EQ(ReadAll(Run() + "/export/missions.csv"), ReadAll(whole + "/export/missions.csv"));
  const CommandResult compared = Ed3r(fmt::format("compare --json {} {}", whole, Run()));
  ExpectDone(compared);
  EXPECT_EQ(nlohmann::json::parse(compared.out)["differences"][0]["pairs"], 4);
  const CommandResult watched = Ed3r("status --watch " + Run());
  ExpectDone(watched);
  EXPECT_TRUE(Says(watched.out, "half: 4 of 4 missions, nothing missing")) << watched.out;
}

TEST_F(PiecesTest, PartsOfAnEarlierPlanCountForTheirStage) {
  const std::string sweep = Write("name: earlier\nmissions: 10\nset: {strategy: rbs, " + kWorld + "}");
  for (const char* shard : {"1/2", "2/2"}) ExpectDone(Piece(sweep, "online", shard));
  ExpectDone(Ed3r(fmt::format("run {} --missions 20 --shard 1/4 --quiet --out {}", sweep, Run())));
  const auto arm = nlohmann::json::parse(Ed3r("status --json " + Run()).out)["arms"][0];
  const CommandResult told = Ed3r("status --stage online " + Run());
  EXPECT_EQ(told.status, 3) << told.err;
  EXPECT_EQ(told.out, fmt::format("stage online: {} missions missing, 0 failed, up to mission 20 of 1 arm\n",
                                  arm["missing"].get<int>()));
}

// A run that is complete, beside parts of a plan that has grown since.
TEST_F(PiecesTest, PartsOfAGrownPlanAreNotLeftOutInSilence) {
  const std::string sweep = Write("name: grows\nmissions: 4\nset: {strategy: rbs, " + kWorld + "}");
  const std::string more = sweep + " --missions 6";
  ExpectDone(Ed3r(fmt::format("run {} --quiet --out {}", sweep, Run())));
  for (const char* shard : {"1/2", "2/2"}) ExpectDone(Piece(more, "online", shard));
  const std::string note = "2 shards of a plan that has grown not counted (stage online: 6 missions per arm ";
  const std::string report = "report --no-figures --no-missions --out " + (scratch_ / "report").string();
  for (const std::string& command : {std::string("digest"), std::string("status --stage online"), report}) {
    const CommandResult result = Ed3r(command + " " + Run());
    ExpectDone(result);
    EXPECT_TRUE(Says(result.err, note)) << command << ": " << result.err;
    EXPECT_TRUE(Says(result.err, fmt::format("'ed3r merge {0} {0}/shards/online/*/'", Run()))) << result.err;
  }
  const CommandResult status = Ed3r("status " + Run());
  EXPECT_EQ(status.status, 1);
  EXPECT_TRUE(Says(status.out, "which 'ed3r merge' takes in")) << status.out;

  // After the run has grown those of before have nothing to add.
  Merge("online");
  ExpectDone(Ed3r(
      fmt::format("run {} --stage online --shard 1/3 --quiet --out {}/shards/online/old", sweep, Run())));
  const CommandResult whole = Ed3r("digest " + Run());
  EXPECT_EQ(whole.err, "");
  ExpectDone(Ed3r(fmt::format("run {} --quiet --out {}", more, (scratch_ / "fresh").string())));
  EXPECT_EQ(whole.out, Ed3r("digest " + (scratch_ / "fresh").string()).out);
  const CommandResult tally = Ed3r("status --json " + Run());
  ExpectDone(tally);
  EXPECT_EQ(nlohmann::json::parse(tally.out)["arms"][0]["done"], 6);
}

TEST_F(PiecesTest, PartsOfAnotherPlanAreToldOrRefused) {
  const std::string sweep = Write("name: other\nmissions: 4\nset: {strategy: rbs, " + kWorld + "}");
  const std::string windy = sweep + " --set environment.wind_x_mps=5";
  ExpectDone(Ed3r(fmt::format("run {} --quiet --out {}", sweep, Run())));
  const CommandResult from = Piece(windy, "online", "1/2");
  EXPECT_EQ(from.status, 2);
  EXPECT_TRUE(Says(from.err, "environment.wind_x_mps is 0 there and 5 here; give another --from"))
      << from.err;
  EXPECT_FALSE(fs::exists(Run() + "/shards")) << "what is refused leaves nothing";

  const auto shard = [&](const std::string& of, const std::string& run, const char* part) {
    ExpectDone(Ed3r(fmt::format("run {} --stage online --shard {}/2 --quiet --out {}/shards/online/{}", of,
                                part, run, part)));
  };
  shard(windy, Run(), "1");
  for (const char* command : {"digest ", "status --stage online "}) {
    const CommandResult result = Ed3r(command + Run());
    ExpectDone(result);
    EXPECT_TRUE(Says(result.err, "1 shard of another plan not counted (")) << result.err;
    EXPECT_TRUE(Says(result.err, "environment.wind_x_mps is 0 there and 5 here")) << result.err;
  }
  const std::string mixed = (scratch_ / "mixed").string();
  shard(sweep, mixed, "1");
  shard(windy, mixed, "2");
  const CommandResult status = Ed3r("status " + mixed);
  EXPECT_EQ(status.status, 1);
  EXPECT_TRUE(Says(status.out, "environment.wind_x_mps is 0 there and 5 here")) << status.out;
  EXPECT_EQ(Ed3r("digest " + mixed).status, 2);
}

// What is owed is of the sweep that is asked for, and what would fly it of the one that the scripts were written for.
TEST_F(PiecesTest, ScriptsOfAnotherSweepAreTold) {
  const std::string sweep = Write(kStages);
  const std::string slurm = fmt::format("slurm {} --out {} --cache {} --time 1-0", sweep, Run(), Cache());
  ExpectDone(Ed3r(slurm + " --seed 3"));
  EXPECT_EQ(Ed3r(slurm + " --seed 3 --missing").err, "");
  const std::string told = fmt::format(
      "{0}/slurm/common.sh: its tasks fly '{1} --seed 3', not '{1} --seed 4' as asked "
      "for here",
      Run(), sweep);
  const CommandResult missing = Ed3r(slurm + " --seed 4 --missing");
  ExpectDone(missing);
  EXPECT_EQ(missing.err, "note: " + told + "\n");
  EXPECT_TRUE(Says(missing.out, "step 1-warmup on")) << missing.out;
  const CommandResult refused = Ed3r(slurm + " --seed 4 --missing --submit");
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.err,
            told + "; give what they were written for, or write the scripts anew with --force\n");
}

// A copied folder's scripts still write into the one that they were made for, also where its name begins with that one's.
TEST_F(PiecesTest, ScriptsOfACopiedFolderAreTold) {
  const std::string sweep = Write(kStages), there = (scratch_ / "a run").string(), here = there + "2";
  ExpectDone(Ed3r(fmt::format("slurm {} --out '{}' --cache {} --time 1-0", sweep, there, Cache())));
  fs::copy(there, here, fs::copy_options::recursive);
  EXPECT_EQ(Ed3r(fmt::format("slurm {} --out '{}' --cache {} --missing", sweep, there, Cache())).err, "");
  const std::string asked = fmt::format("slurm {} --out '{}' --cache {} --missing", sweep, here, Cache());
  EXPECT_TRUE(Says(Ed3r(asked).err, fmt::format("its tasks write into '{}', not into '{}'", there, here)));
  EXPECT_EQ(Ed3r(asked + " --submit").status, 2);
}

}  // namespace
}  // namespace ed3r::app
