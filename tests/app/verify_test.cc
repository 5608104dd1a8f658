// Whether results can be believed, as users ask it: verify, diff, run --repair, a run directory carried elsewhere.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kRbs = ED3R_SOURCE_DIR "/sweeps/rbs.yaml";

bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string FlyRbs(const fs::path& dir, const std::string& arguments = "") {
  return fmt::format("run {} --missions 4 --quiet --out {} {}", kRbs, dir.string(), arguments);
}

// Another number in the file, as a bad disk or a hand would leave it.
void Sql(const fs::path& dir, const std::string& sql) {
  const std::string line = fmt::format(
      "/usr/bin/python3 -c \"import sqlite3; d = sqlite3.connect('{}'); d.execute(\\\"{}\\\"); d.commit()\"",
      (dir / "results.sqlite").string(), sql);
  ASSERT_EQ(std::system(line.c_str()), 0) << line;
}

// One bit of a mission's record turns, and the file's times stay, as a bad disk leaves it.
void Rot(const fs::path& dir) {
  const std::string line = fmt::format(
      "/usr/bin/python3 -c \"import os, sqlite3; f = '{}'; was = os.stat(f); d = sqlite3.connect(f); c = "
      "d.execute('SELECT steps_checksum FROM missions').fetchone()[0]; d.close(); b = open(f, 'rb').read(); "
      "i "
      "= b.find(c.encode()) + 200; o = open(f, 'r+b'); o.seek(i); o.write(bytes([b[i] ^ 16])); o.close(); "
      "os.utime(f, ns=(was.st_atime_ns, was.st_mtime_ns))\"",
      (dir / "results.sqlite").string());
  ASSERT_EQ(std::system(line.c_str()), 0) << line;
}

class VerifyTest : public ::testing::Test {
 protected:
  VerifyTest() {
    const CommandResult flown = Ed3r(FlyRbs(Run()));
    EXPECT_EQ(flown.status, 0) << flown.err;
    digest_ = Ed3r("digest " + Run().string()).out;
  }
  fs::path Run() const { return scratch_ / "run"; }

  ScratchFolder scratch_;
  std::string digest_;
};

TEST_F(VerifyTest, AWholeRunIsCalledWhole) {
  const CommandResult verified = Ed3r("verify " + Run().string());
  EXPECT_EQ(verified.status, 0);
  EXPECT_EQ(verified.out, Run().string() + ": 4 missions whole\n");
  EXPECT_TRUE(json::parse(Ed3r("verify --json " + Run().string()).out)["whole"]);
  EXPECT_EQ(Ed3r("verify " + (scratch_ / "none").string()).status, 2);
}

TEST_F(VerifyTest, ARunWhoseChecksumsAreGoneIsNotWhole) {
  Sql(Run(), "DROP VIEW named_missions");
  Sql(Run(), "ALTER TABLE missions DROP COLUMN checksum");
  Sql(Run(), "UPDATE missions SET total_j = total_j / 2");
  const std::string dir = Run().string(), gone = "its table missions has no column checksum";
  const CommandResult verified = Ed3r("verify " + dir);
  EXPECT_EQ(verified.status, 1);
  EXPECT_TRUE(Contains(verified.out, gone)) << verified.out;
  for (const std::string& command : {"digest " + dir, "report --no-figures " + dir, "status " + dir,
                                     "merge " + (scratch_ / "merged").string() + " " + dir, FlyRbs(Run())}) {
    const CommandResult refused = Ed3r(command);
    EXPECT_EQ(refused.status, 2) << command;
    EXPECT_TRUE(Contains(refused.err, gone)) << command << ": " << refused.err;
  }
}

TEST_F(VerifyTest, AFileOfFormat1IsToldToHaveNoChecksums) {
  const fs::path old = scratch_ / "old";
  fs::create_directories(old);
  fs::copy_file(ED3R_SOURCE_DIR "/tests/store/data/format1.sqlite", old / "results.sqlite");
  const std::string dir = old.string(), said = "without checksums (format 1): nothing of it can be compared";
  const CommandResult verified = Ed3r("verify " + dir);
  EXPECT_EQ(verified.status, 1);
  EXPECT_EQ(verified.out, dir + ": 3 missions, " + said + "\n");
  EXPECT_FALSE(json::parse(Ed3r("verify --json " + dir).out)["whole"]);
  EXPECT_TRUE(Contains(Ed3r("status " + dir).out, said));
  EXPECT_FALSE(json::parse(Ed3r("status --json " + dir).out)["checked"]);
  EXPECT_EQ(Ed3r("digest " + dir).err, "note: " + said + "\n");
  const CommandResult reported = Ed3r("report --no-figures --no-missions " + dir);
  EXPECT_EQ(reported.status, 0) << reported.err;
  EXPECT_TRUE(Contains(reported.out, said));
  const CommandResult merged = Ed3r("merge " + (scratch_ / "merged").string() + " " + dir);
  EXPECT_EQ(merged.status, 2);
  EXPECT_TRUE(Contains(merged.err, said)) << merged.err;
}

TEST_F(VerifyTest, EveryCommandRefusesADamagedMissionAndARepairFliesItAgain) {
  Sql(Run(), "UPDATE timesteps SET scs = scs + 1e-9 WHERE mission = 2 AND k = 1");
  const std::string dir = Run().string();
  for (const std::string& command :
       {"digest " + dir, "report --no-figures " + dir, "replay " + dir + " rbs/2",
        "explain --step 1 " + dir + " rbs/2", FlyRbs(Run()),
        "merge " + (scratch_ / "merged").string() + " " + dir, "diff " + dir + " " + dir}) {
    const CommandResult refused = Ed3r(command);
    EXPECT_EQ(refused.status, 2) << command;
    EXPECT_TRUE(
        Contains(refused.err,
                 "stage online, arm rbs, mission 2 is damaged: its timesteps do not match their checksum; "
                 "'ed3r verify DIR' names all that is damaged, 'ed3r run SWEEP --repair' flies it again"))
        << command << ": " << refused.err;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
  }
  EXPECT_FALSE(fs::exists(Run() / "report"));
  const CommandResult verified = Ed3r("verify " + dir);
  EXPECT_EQ(verified.status, 1);
  EXPECT_TRUE(Contains(verified.out,
                       "stage online, arm rbs, mission 2: its timesteps do not match their checksum\n"));
  const json object = json::parse(Ed3r("verify --json " + dir).out);
  EXPECT_FALSE(object["whole"]);
  EXPECT_EQ(object["damaged"].size(), 1u);

  const CommandResult repaired = Ed3r(fmt::format("run {} --missions 4 --repair --out {}", kRbs, dir));
  EXPECT_EQ(repaired.status, 0) << repaired.err;
  EXPECT_TRUE(Contains(repaired.out, "repaired: stage online, arm rbs, mission 2: "));
  EXPECT_EQ(Ed3r("digest " + dir).out, digest_);
  EXPECT_EQ(Ed3r("verify " + dir).status, 0);
}

// What is not flown again by the same call stays where it is.
TEST(RepairTest, APartTakesNothingElseOut) {
  const ScratchFolder scratch;
  const std::string sweep = (scratch / "two.yaml").string(), run = (scratch / "run").string();
  std::ofstream(sweep) << "base: " << kRbs
                       << "\nname: two\nmissions: 4\nstages:\n  - {name: first}\n  - {name: second, after: "
                          "first, set: {robot.speed_mps: 4}}\n";
  const std::string fly = fmt::format("run {} --out {} ", sweep, run);
  ASSERT_EQ(Ed3r(fly).status, 0);
  const std::string whole = Ed3r("digest " + run).out;
  Sql(scratch / "run", "UPDATE missions SET total_j = 1 WHERE run = 0 AND mission = 2");
  for (const char* part : {"--stage second", "--only-failed", "--shard 2/2", "--stage first --shard 2/2"}) {
    const CommandResult refused = Ed3r(fly + "--repair " + part);
    EXPECT_EQ(refused.status, 2) << part;
    EXPECT_EQ(refused.err,
              run +
                  ": stage first, arm rbs, mission 2 is damaged: its record does not match its checksum; "
                  "--repair takes out only what the same call flies again, and this one does not: 'ed3r run "
                  "SWEEP --repair' without --stage, --shard and --only-failed does\n");
    EXPECT_TRUE(Contains(Ed3r("verify " + run).out, "stage first, arm rbs, mission 2: ")) << part;
  }
  const CommandResult grown = Ed3r(fly + "--repair --missions first=5 --stage second");
  EXPECT_EQ(grown.status, 2);
  EXPECT_TRUE(Contains(grown.err, "stage first, arm rbs, mission 2 is damaged: ")) << grown.err;
  EXPECT_TRUE(Contains(Ed3r("verify " + run).out, "stage first, arm rbs, mission 2: "));

  // A stage that is refused for another reason has lost nothing.
  Sql(scratch / "run", "UPDATE missions SET total_j = 1 WHERE run = 1 AND mission = 3");
  ASSERT_EQ(Ed3r(fly + "--repair").status, 0);
  EXPECT_EQ(Ed3r("digest " + run).out, whole);
  Sql(scratch / "run", "DELETE FROM missions WHERE run = 0 AND mission = 1");
  Sql(scratch / "run", "DELETE FROM timesteps WHERE run = 0 AND mission = 1");
  Sql(scratch / "run", "UPDATE missions SET total_j = 1 WHERE run = 1 AND mission = 3");
  EXPECT_TRUE(Contains(Ed3r(fly + "--repair --stage second").err, "1 missions are missing or failed"));
  EXPECT_TRUE(Contains(Ed3r("verify " + run).out, "stage second, arm rbs, mission 3: "));

  // Nor has one that waits.
  for (const char* part : {"--shard 1/2", "--shard 2/2"}) {
    EXPECT_EQ(Ed3r(fly + "--repair " + part).status, 2) << part;
    EXPECT_TRUE(Contains(Ed3r("verify " + run).out, "stage second, arm rbs, mission 3: ")) << part;
  }
  ASSERT_EQ(Ed3r(fly + "--repair --stage first --shard 2/2").status, 2);
  ASSERT_EQ(Ed3r(fly + "--repair").status, 0);
  EXPECT_EQ(Ed3r("digest " + run).out, whole);
  Sql(scratch / "run", "UPDATE missions SET total_j = 1 WHERE run = 1 AND mission = 3");
  const CommandResult damaged = Ed3r("status --stage second " + run);
  EXPECT_EQ(damaged.status, 1) << damaged.out;
  EXPECT_TRUE(Contains(damaged.out, "stage second: damaged: stage second, arm rbs, mission 3: "))
      << damaged.out;
  EXPECT_EQ(Ed3r("status --stage first " + run).status, 0);
  EXPECT_TRUE(Contains(Ed3r(fly + "--repair --stage second").out, "repaired: stage second, arm "));
  EXPECT_EQ(Ed3r("digest " + run).out, whole);
}

TEST_F(VerifyTest, ARunThatWasFoundCompleteIsComparedAgain) {
  ASSERT_EQ(Ed3r(FlyRbs(Run())).status, 0);  // remembered as complete
  Rot(Run());
  const CommandResult again = Ed3r(FlyRbs(Run()));
  EXPECT_EQ(again.status, 2) << again.out;
  EXPECT_TRUE(Contains(again.err, "its record does not match its checksum")) << again.err;
  EXPECT_EQ(Ed3r("verify " + Run().string()).status, 1);
}

// Shards of the plan before it grew, beside a run that has the grown one and lacks missions of it.
TEST_F(VerifyTest, ShardsCountForEveryReader) {
  const fs::path run = scratch_ / "parts", shard = run / "shards/online/00001";
  ASSERT_EQ(Ed3r(FlyRbs(shard, "--shard 1/2")).status, 0);
  const std::string few = FlyRbs(run, "--shard 2/2");
  ASSERT_EQ(Ed3r(fmt::format("{} --missions online=6", few)).status, 0);
  const std::string dir = run.string(), whole = Run().string();
  EXPECT_EQ(json::parse(Ed3r("status --json " + dir).out)["arms"][0]["done"], 5);
  EXPECT_EQ(Ed3r("verify " + dir).out, dir + ": 5 missions whole in 2 stores\n");
  EXPECT_TRUE(Contains(Ed3r("diff " + dir + " " + whole).out,
                       "4 missions compared, 0 differ; 1 only in the first, 0 only in the second"));
  EXPECT_EQ(json::parse(Ed3r("digest --json " + dir).out)["missions"], 5);
  for (const int mission : {0, 1})
    EXPECT_EQ(
        Ed3r(fmt::format("replay {} rbs/{} --out {}", dir, mission, (scratch_ / "replay").string())).status,
        0);
  Sql(shard, "UPDATE missions SET total_j = 1");
  const CommandResult verified = Ed3r("verify " + dir);
  EXPECT_EQ(verified.status, 1);
  EXPECT_TRUE(Contains(verified.out, shard.string() + ": stage online, arm rbs, mission ")) << verified.out;
  EXPECT_EQ(json::parse(Ed3r("verify --json " + dir).out)["damaged"][0]["store"], shard.string());
}

// What a complete run tells is in it: a shard beside it that says to hold more is damaged, and nobody needs it.
TEST_F(VerifyTest, ADamagedShardBesideACompleteRunIsNamedByVerifyAlone) {
  const fs::path shard = Run() / "shards/online/00001";
  ASSERT_EQ(Ed3r(FlyRbs(shard, "--shard 1/2")).status, 0);
  Sql(shard, "UPDATE missions SET mission = mission + 40");
  const std::string dir = Run().string();
  const CommandResult digested = Ed3r("digest " + dir), verified = Ed3r("verify " + dir);
  EXPECT_EQ(digested.status, 0) << digested.err;
  EXPECT_EQ(digested.out, digest_);
  EXPECT_EQ(json::parse(Ed3r("status --json " + dir).out)["arms"][0]["done"], 4);
  EXPECT_EQ(Ed3r("report --no-figures --no-missions " + dir).status, 0);
  EXPECT_EQ(verified.status, 1);
  EXPECT_TRUE(Contains(verified.out, shard.string() + ": ")) << verified.out;
}

TEST_F(VerifyTest, NamesThatAreNotUtf8HaveTheirPlaceInJson) {
  const fs::path shards = Run() / "shards/online", shard = shards / "1\xff";
  fs::create_directories(shard);
  std::ofstream(shard / "results.sqlite") << "no database";
  const std::string dir = Run().string(), named = (shards / "1\ufffd").string();
  EXPECT_EQ(json::parse(Ed3r("status --json " + dir).out)["unreadable"][0]["store"], named);
  EXPECT_EQ(json::parse(Ed3r("verify --json " + dir).out)["other"][0],
            named + "/results.sqlite: not a results file (file is not a database)");
  const std::string sweeps = "ED3R_SWEEPS=" + shard.string();
  EXPECT_EQ(json::parse(Ed3r("doctor --json", sweeps).out)["machine"]["shipped sweeps"], named);
  fs::copy(Run() / "results.sqlite", shard, fs::copy_options::overwrite_existing);
  const std::string here = fmt::format("cd {} &&", shard.string());
  EXPECT_EQ(json::parse(Ed3r("compare --json . ../../..", here).out)["runs"][0], "1\ufffd");
}

TEST_F(VerifyTest, StatusNamesAMissionThatIsNotPlanned) {
  Sql(Run(), "UPDATE missions SET mission = 9 WHERE mission = 3");
  const CommandResult status = Ed3r("status " + Run().string());
  EXPECT_EQ(status.status, 1);
  EXPECT_TRUE(
      Contains(status.out, "the first stage online, arm rbs, mission 9: the plan has no such mission"))
      << status.out;
  EXPECT_EQ(Ed3r(FlyRbs(Run())).status, 2);
  EXPECT_EQ(Ed3r(FlyRbs(Run(), "--repair")).status, 0);
  EXPECT_EQ(Ed3r("digest " + Run().string()).out, digest_);
}

TEST_F(VerifyTest, DiffNamesTheFirstQuantity) {
  ASSERT_EQ(Ed3r(FlyRbs(scratch_ / "same")).status, 0);
  const CommandResult same = Ed3r(fmt::format("diff {} {}", Run().string(), (scratch_ / "same").string()));
  EXPECT_EQ(same.status, 0);
  EXPECT_EQ(same.out, "identical: 4 missions\n");
  ASSERT_EQ(Ed3r(FlyRbs(scratch_ / "other", "--set robot.mass_kg=1.5")).status, 0);
  const std::string both = fmt::format("diff {} {}", Run().string(), (scratch_ / "other").string());
  const CommandResult other = Ed3r(both);
  EXPECT_EQ(other.status, 1);
  EXPECT_TRUE(Contains(other.out, "stage online, arm rbs, mission 0, timestep 1: ")) << other.out;
  const json first = json::parse(Ed3r(both + " --json").out);
  EXPECT_EQ(first["differing"], 4);
  EXPECT_EQ(first["first"]["timestep"], 1);
  EXPECT_NE(first["first"]["first"], first["first"]["second"]);
}

// What is kept of a flight is the user's choice, what it was is not.
TEST(KeptTimestepsTest, ARunWithoutTimestepsIsTheSameRun) {
  const ScratchFolder scratch;
  const std::string all = (scratch / "all").string(), none = (scratch / "none").string();
  const std::string sweep = (scratch / "none.yaml").string();
  std::ofstream(sweep) << "base: " << kRbs << "\nname: rbs\nstore: {timesteps: none}\n";
  ASSERT_EQ(Ed3r(fmt::format("run {} --missions 4 --quiet --out {}", kRbs, all)).status, 0);
  const CommandResult flown = Ed3r(fmt::format("run {} --missions 4 --quiet --out {}", sweep, none));
  ASSERT_EQ(flown.status, 0) << flown.err;

  EXPECT_EQ(Ed3r("digest " + none).out, Ed3r("digest " + all).out);
  EXPECT_EQ(Ed3r("verify " + none).status, 0);
  EXPECT_EQ(Ed3r(fmt::format("diff {} {}", all, none)).status, 0);
  const CommandResult replayed =
      Ed3r(fmt::format("replay {} rbs/2 --out {}", none, (scratch / "r").string()));
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_TRUE(Contains(replayed.out, "identical to the stored record")) << replayed.out;
  const CommandResult explained = Ed3r(fmt::format("explain {} rbs/2 --step 1", none));
  EXPECT_EQ(explained.status, 0) << explained.err;
  const std::string report = " --json --no-figures --no-missions --out ";
  const auto with = nlohmann::json::parse(Ed3r("report " + all + report + (scratch / "ra").string()).out);
  const auto without = nlohmann::json::parse(Ed3r("report " + none + report + (scratch / "rn").string()).out);
  EXPECT_EQ(with["arms"], without["arms"]);
  const CommandResult exported =
      Ed3r(fmt::format("export {} --csv --out {}", none, (scratch / "e").string()));
  EXPECT_EQ(exported.status, 0) << exported.err;
  EXPECT_TRUE(Contains(exported.err, "stage online: timesteps of 0 of 4 missions were kept")) << exported.err;
  EXPECT_EQ(Ed3r(fmt::format("export {} --csv --out {}", all, (scratch / "f").string())).err, "");

  const CommandResult other = Ed3r(fmt::format("run {} --missions 4 --quiet --out {}", kRbs, none));
  EXPECT_EQ(other.status, 2);
  EXPECT_EQ(std::count(other.err.begin(), other.err.end(), '\n'), 1) << other.err;
}

// Sweep, world, grid and network cache are gone, and the folder is called otherwise.
TEST(SelfContainedTest, ARunDirectoryNeedsNothingBesideItself) {
  const ScratchFolder scratch;
  const fs::path sources = scratch / "sources";
  fs::create_directories(sources);
  fs::copy(ED3R_SOURCE_DIR "/sweeps/worlds", sources / "worlds", fs::copy_options::recursive);
  std::ofstream(sources / "study.yaml") << R"(name: study
seed: 3
set: {training.epochs: 3, mission.world: worlds/cascades.yaml}
stages:
  - {name: warmup, missions: 6, set: {strategy: random, mission.sites: known, mission.base_stations: known}}
  - {name: training, kind: train, after: warmup}
  - {name: online, after: training, missions: 3, set: {strategy: ed3r}}
)";
  const CommandResult flown =
      Ed3r(fmt::format("run {} --quiet --cache {} --out {}", (sources / "study.yaml").string(),
                       (sources / "cache").string(), (scratch / "run").string()));
  ASSERT_EQ(flown.status, 0) << flown.err;
  const std::string report = Ed3r("report --no-figures --json " + (scratch / "run").string()).out;
  const std::string explained =
      Ed3r(fmt::format("explain {} online/ed3r-75/1 --step 1 --json", (scratch / "run").string())).out;
  ASSERT_TRUE(Contains(explained, "candidates")) << explained;
  fs::remove_all(sources);
  fs::rename(scratch / "run", scratch / "moved");
  const std::string moved = (scratch / "moved").string();

  const CommandResult again = Ed3r("report --no-figures --json " + moved);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.out, report);
  const std::string data = ReadAll(scratch / "moved/report/figures/data.json");
  EXPECT_TRUE(!Contains(data, "\"world\":null") && !Contains(data, "\"world\": null")) << data.substr(0, 400);
  EXPECT_EQ(Ed3r(fmt::format("explain {} online/ed3r-75/1 --step 1 --json", moved)).out, explained);
  const std::string no_cache = (scratch / "no-cache").string();
  const CommandResult replayed = Ed3r(fmt::format("replay {} online/ed3r-75/1 --cache {}", moved, no_cache));
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_TRUE(Contains(replayed.out, "identical to the stored record")) << replayed.out;
  EXPECT_FALSE(fs::exists(no_cache)) << "it was trained again";
  EXPECT_EQ(Ed3r("verify " + moved).status, 0);

  // A damaged network: what is of missions is right, and everyone who looks is told.
  const std::string digest = Ed3r("digest " + moved).out;
  Sql(scratch / "moved",
      "UPDATE networks SET model = zeroblob(length(model)) WHERE sha256 = (SELECT min(sha256) FROM "
      "networks)");
  const std::string damage = "/results.sqlite: the file is damaged: its network '";
  const CommandResult digested = Ed3r("digest " + moved), status = Ed3r("status " + moved);
  EXPECT_EQ(digested.status, 0);
  EXPECT_EQ(digested.out, digest);
  EXPECT_TRUE(Contains(digested.err, "note: " + moved + damage)) << digested.err;
  EXPECT_EQ(status.status, 1);
  EXPECT_TRUE(Contains(status.out, moved + damage)) << status.out;
  const json status_json = json::parse(Ed3r("status --json " + moved).out);
  ASSERT_EQ(status_json["other"].size(), 1u);
  EXPECT_TRUE(Contains(status_json["other"][0], damage));
  const CommandResult reported = Ed3r("report --no-figures " + moved);
  EXPECT_EQ(reported.status, 0);
  EXPECT_TRUE(Contains(reported.err, "note: " + moved + damage)) << reported.err;
  EXPECT_EQ(Ed3r("verify " + moved).status, 1);
}

}  // namespace
}  // namespace ed3r::app
