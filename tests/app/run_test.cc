// The program as its users meet it: the same results however a sweep is flown, and what happens when things go wrong.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

const std::string kSweeps = ED3R_SOURCE_DIR "/sweeps/";

std::string Digest(const fs::path& dir) {
  const CommandResult result = Ed3r("digest " + dir.string());
  EXPECT_EQ(result.status, 0) << result.err;
  return result.out;
}

// Flies a shipped sweep and returns its digest.
std::string Fly(const std::string& sweep, const std::string& arguments, const fs::path& dir,
                const std::string& environment = "") {
  const CommandResult result =
      Ed3r(fmt::format("run {}{} {} --quiet --out {}", kSweeps, sweep, arguments, dir.string()), environment);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return Digest(dir);
}

std::int64_t DoneMissions(const fs::path& dir) {
  const CommandResult result = Ed3r("status --json " + dir.string());
  if (result.status != 0) return 0;  // not there yet
  std::int64_t done = 0;
  const auto status = nlohmann::json::parse(result.out);
  for (const auto& arm : status.at("arms")) done += arm.at("done").get<std::int64_t>();
  return done;
}

// Starts `ed3r run`, waits until some missions are stored, sends a signal; returns the wait status.
int RunAndSignal(const std::string& sweep, const std::string& missions, const fs::path& dir, int signal,
                 std::int64_t after_missions) {
  const std::string file = kSweeps + sweep;
  const std::string out = dir.string();
  const pid_t child = fork();
  if (child == 0) {
    execl(ED3R_BINARY, ED3R_BINARY, "run", file.c_str(), "--missions", missions.c_str(), "--quiet", "--out",
          out.c_str(), nullptr);
    _exit(127);
  }
  // Waits for an event, not for a time: the deadline only ends a test that is broken anyway.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (DoneMissions(dir) < after_missions && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  kill(child, signal);
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(RunTest, ThreadsShardsAndSimdLevelsDoNotShow) {
  const ScratchFolder scratch;
  const std::string one = Fly("rbs.yaml", "--missions 30 --threads 1", scratch / "one");
  EXPECT_EQ(Fly("rbs.yaml", "--missions 30 --threads 2", scratch / "two"), one);
  EXPECT_EQ(Fly("rbs.yaml", "--missions 30", scratch / "scalar", "ED3R_SIMD=scalar"), one);
  for (const char* shard : {"3/3", "1/3", "2/3"})
    Fly("rbs.yaml", fmt::format("--missions 30 --shard {}", shard),
        scratch / fmt::format("shard{}", shard[0]));
  const std::string merge =
      fmt::format("merge {} {} {} {}", (scratch / "merged").string(), (scratch / "shard2").string(),
                  (scratch / "shard3").string(), (scratch / "shard1").string());
  ASSERT_EQ(Ed3r(merge).status, 0);
  EXPECT_EQ(Digest(scratch / "merged"), one);
  EXPECT_NE(Fly("rbs.yaml", "--missions 30 --seed 1", scratch / "seed"), one);
}

TEST(RunTest, EveryCommandSaysHowMuchOfThePlanItHas) {
  const ScratchFolder scratch;
  const std::string whole = (scratch / "whole").string(), half = (scratch / "half").string(),
                    merged = (scratch / "merged").string();
  Fly("rbs.yaml", "--missions 4", whole);
  Fly("rbs.yaml", "--missions 4 --shard 1/2", half);
  const std::string part = " 2 of 4 planned missions\n";
  EXPECT_EQ(Ed3r(fmt::format("merge {} {}", merged, half)).err,
            fmt::format("note: {}: holds{}", merged, part));
  EXPECT_EQ(Ed3r("export --csv " + merged).err, fmt::format("note: {}: the tables are of{}", merged, part));
  EXPECT_NE(Ed3r("report --no-figures --no-missions " + merged).err.find(": the report is of" + part),
            std::string::npos);
  EXPECT_EQ(Ed3r("digest " + merged).err, "note: this is the digest of" + part);
  EXPECT_EQ(Ed3r(fmt::format("compare {} {}", whole, merged)).err,
            fmt::format("note: {}: is compared by{}", merged, part));
}

TEST(RunTest, VerifySaysThatShardsAreOfAnotherRun) {
  const ScratchFolder scratch;
  const auto shard = [&](int i) { return scratch / fmt::format("run/shards/online/{}", i); };
  Fly("rbs.yaml", "--missions 4 --shard 1/2", shard(1));
  Fly("rbs.yaml", "--missions 4 --shard 2/2 --seed 5", shard(2));
  const CommandResult digest = Ed3r("digest " + (scratch / "run").string()),
                      verify = Ed3r("verify " + (scratch / "run").string());
  EXPECT_EQ(digest.status, 2);
  EXPECT_EQ(verify.status, 1);
  EXPECT_EQ(verify.out, digest.err);
  Fly("rbs.yaml", "--missions 4", scratch / "run");
  const std::string complete = (scratch / "run").string();
  EXPECT_EQ(Ed3r("verify " + complete).err, Ed3r("digest " + complete).err)
      << "a note, as it is complete without";
}

TEST(RunTest, AKillLosesLittleAndTheSameCommandContinues) {
  const ScratchFolder scratch;
  const std::string whole = Fly("rbs.yaml", "--missions 250", scratch / "whole");
  const int status = RunAndSignal("rbs.yaml", "250", scratch / "killed", SIGKILL, 20);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it ended before the kill";
  const std::int64_t before = DoneMissions(scratch / "killed");
  EXPECT_GE(before, 20);
  EXPECT_LT(before, 250);
  EXPECT_EQ(Fly("rbs.yaml", "--missions 250", scratch / "killed"), whole);
}

TEST(RunTest, CtrlCExitsWith130AndABatchSystemsSignalWith75AndBothKeepWhatIsStored) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU}) {
    const ScratchFolder scratch;
    const int status = RunAndSignal("rbs.yaml", "2000", scratch / "run", signal, 10);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), signal == SIGINT ? 130 : 75);
    EXPECT_GE(DoneMissions(scratch / "run"), 10);
    EXPECT_LT(DoneMissions(scratch / "run"), 2000);
    EXPECT_EQ(Ed3r("verify " + (scratch / "run").string()).status, 0);
  }
}

TEST(RunTest, ARunThatIsCompleteFliesNothingAgain) {
  const ScratchFolder scratch;
  Fly("rbs.yaml", "--missions 4", scratch / "run");
  const CommandResult again =
      Ed3r(fmt::format("run {}rbs.yaml --missions 4 --out {}", kSweeps, (scratch / "run").string()));
  EXPECT_EQ(again.status, 0);
  EXPECT_NE(again.out.find("4 missions stored (4 before)\n"), std::string::npos) << again.out;
}

TEST(RunTest, TheManifestNamesTheSessionThatFlew) {
  const ScratchFolder scratch;
  Fly("rbs.yaml", "--missions 4", scratch / "run", "ED3R_SIMD=scalar");
  Fly("rbs.yaml", "--missions 4", scratch / "run", "ED3R_SIMD=avx2");  // finds all of them flown
  ASSERT_EQ(Ed3r(fmt::format("report {} --no-figures", (scratch / "run").string())).status, 0);
  const std::string manifest = ReadAll(scratch / "run" / "report" / "manifest.json");
  EXPECT_NE(manifest.find("\"simd\": \"scalar\""), std::string::npos) << manifest;
}

// Warm-up, training and every strategy of the paper, at each SIMD level this CPU has and on one and two threads.
TEST(RunTest, TheWholePaperInSmallIsTheSameAtEverySimdLevel) {
  const ScratchFolder scratch;
  const auto fly = [&](const std::string& name, const std::string& arguments,
                       const std::string& environment) {
    return Fly("smoke.yaml",
               fmt::format("--missions 6 --set training.epochs=3 --cache {} {}",
                           (scratch / (name + "-cache")).string(), arguments),
               scratch / name, environment);
  };
  const std::string reference = fly("reference", "--threads 2", "");
  EXPECT_EQ(fly("one-thread", "--threads 1", ""), reference);
  const std::string levels =
      nlohmann::json::parse(Ed3r("doctor --json").out).at("machine").at("simd_supported");
  for (const char* level : {"scalar", "avx2", "avx512"}) {
    if (levels.find(level) == std::string::npos) continue;
    EXPECT_EQ(fly(level, "", fmt::format("ED3R_SIMD={}", level)), reference) << level;
  }
}

TEST(RunTest, FailedMissionsAreRecordedAndTheSweepGoesOn) {
  const ScratchFolder scratch;
  const CommandResult result =
      Ed3r(fmt::format("run {}rbs.yaml --missions 12 --set mission.max_timesteps=8 --quiet --out {}", kSweeps,
                       (scratch / "run").string()));
  EXPECT_EQ(result.status, 3);
  const auto status = nlohmann::json::parse(Ed3r("status --json " + (scratch / "run").string()).out);
  const std::int64_t done = status["arms"][0]["done"], failed = status["arms"][0]["failed"];
  EXPECT_EQ(done + failed, 12);
  EXPECT_GT(done, 0);
  EXPECT_GT(failed, 0);
  EXPECT_NE(status["failures"][0]["message"].get<std::string>().find("the mission does not end"),
            std::string::npos);
  EXPECT_EQ(status["failures"][0]["seed"], 20260101);
  EXPECT_EQ(status["failures"][0]["kind"], "mission-ends");
  EXPECT_EQ(status["failure_kinds"], nlohmann::json({{"mission-ends", failed}}));
  const std::string text = Ed3r("status " + (scratch / "run").string()).out;
  EXPECT_NE(text.find(fmt::format("failed, mission-ends: {} mission", failed)), std::string::npos) << text;
}

TEST(RunTest, OnlyWhatHasFailedIsFlownAgainWhereAsked) {
  const ScratchFolder scratch;
  const std::string run = fmt::format("run {}rbs.yaml --missions 12 --set mission.max_timesteps=8 --out {}",
                                      kSweeps, (scratch / "run").string());
  ASSERT_EQ(Ed3r(run + " --quiet --shard 1/2").status, 3);
  const auto counts = [&] {
    const auto arm =
        nlohmann::json::parse(Ed3r("status --json " + (scratch / "run").string()).out)["arms"][0];
    return std::array<std::int64_t, 3>{arm["done"], arm["failed"], arm["missing"]};
  };
  const auto before = counts();
  EXPECT_EQ(before[2], 6);
  const CommandResult again = Ed3r(run + " --only-failed");
  EXPECT_EQ(again.status, 3) << "they fail again";
  EXPECT_NE(again.out.find(fmt::format("{} failed", before[1])), std::string::npos) << again.out;
  EXPECT_EQ(counts(), before) << "what is missing is left";
  std::string larger = run;
  larger.replace(larger.find("12"), 2, "14");
  const CommandResult more = Ed3r(larger + " --only-failed");
  EXPECT_EQ(more.status, 2);
  EXPECT_NE(more.err.find("--only-failed flies nothing that is missing, and the plan asks for more than is "
                          "there (stage online: 14 missions per arm for 12)"),
            std::string::npos)
      << more.err;
  EXPECT_EQ(counts(), before) << "nothing has grown";
}

TEST(RunTest, StatusSeesWhatIsDamaged) {
  const ScratchFolder scratch;
  Fly("rbs.yaml", "--missions 4", scratch / "run");
  EXPECT_EQ(Ed3r("status " + (scratch / "run").string()).status, 0);
  const std::string change = "UPDATE timesteps SET scs = scs + 1e-9 WHERE mission = 2 AND k = 1";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((scratch / "run" / "results.sqlite").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, change.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const CommandResult status = Ed3r("status " + (scratch / "run").string());
  EXPECT_EQ(status.status, 1);
  EXPECT_NE(status.out.find("damaged: 1 mission, the first stage online, arm rbs, mission 2: its timesteps"),
            std::string::npos)
      << status.out;
  const auto json = nlohmann::json::parse(Ed3r("status --json " + (scratch / "run").string()).out);
  EXPECT_EQ(json["damaged"].size(), 1u);
}

TEST(RunTest, AnotherSweepInTheSameFolderIsRefused) {
  const ScratchFolder scratch;
  Fly("rbs.yaml", "--missions 2", scratch / "run");
  const std::string digest = Digest(scratch / "run");
  const CommandResult other =
      Ed3r(fmt::format("run {}rbs.yaml --missions 2 --seed 3 --out {}", kSweeps, (scratch / "run").string()));
  EXPECT_EQ(other.status, 2);
  EXPECT_EQ(std::count(other.err.begin(), other.err.end(), '\n'), 1) << other.err;
  EXPECT_EQ(Digest(scratch / "run"), digest);
}

TEST(RunTest, AnArmOfTwoStagesIsNamedWithItsStage) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "two.yaml")
      << "name: two\nset: {strategy: rbs, mission.world: " << kSweeps
      << "worlds/ridges.yaml}\nstages:\n"
         "  - {name: a, missions: 1, sweep: {list: [{name: x}, {name: z}]}}\n"
         "  - {name: b, missions: 1, sweep: {list: [{name: x}, {name: y}]}}\n";
  const std::string dir = (scratch / "run").string();
  ASSERT_EQ(Ed3r(fmt::format("run {} --quiet --out {}", (scratch / "two.yaml").string(), dir)).status, 0);
  const CommandResult either = Ed3r("replay " + dir + " x/0");
  EXPECT_EQ(either.status, 2);
  EXPECT_NE(either.err.find("x/0: arm x is of several stages; give STAGE/ARM/NUMBER, with one of a/x, b/x\n"),
            std::string::npos)
      << either.err;
  for (const char* mission : {" b/x/0", " z/0"}) {
    const CommandResult one = Ed3r("replay " + dir + mission);
    EXPECT_EQ(one.status, 0) << one.err;
  }

  // Into one folder: what is of another mission does not stay beside this one's.
  const fs::path out = scratch / "out";
  const auto replay = [&](const char* mission) {
    return Ed3r(fmt::format("replay {} {} --out {}", dir, mission, out.string())).status;
  };
  const auto names = [&] {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(out)) found.insert(entry.path().filename().string());
    return found;
  };
  ASSERT_EQ(replay("b/x/0"), 0);
  const std::set<std::string> of_others = {"mine.png", "step-1.png"},
                              of_replay = {"map.png", "timesteps.csv", "trace.csv"},
                              of_options = {"mission.html", "step003_large.png", "step003_frames.png"};
  for (const std::set<std::string>& some : {of_others, of_options})
    for (const std::string& name : some) std::ofstream(out / name) << "there before";
  std::set<std::string> kept = of_others;
  kept.insert(of_replay.begin(), of_replay.end());
  std::set<std::string> all = kept;
  all.insert(of_options.begin(), of_options.end());
  ASSERT_EQ(replay("b/x/0"), 0);
  EXPECT_EQ(names(), all) << "the same mission";
  fs::remove(out / "timesteps.csv");  // as a kill leaves it
  ASSERT_EQ(replay("b/x/0"), 0);
  EXPECT_EQ(names(), kept);
  const int other = open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  EXPECT_EQ(replay("a/x/0"), 2) << "another ed3r writes there";
  close(other);
}

TEST(RunTest, ARunGrowsIntoWhatAFreshOneOfThatSizeIs) {
  const ScratchFolder scratch;
  const auto sweep = [&](const char* name, const char* masses) {
    std::ofstream(scratch / name) << "name: grows\nseed: 3\nset: {strategy: rbs, mission.world: " << kSweeps
                                  << "worlds/paper.yaml}\nsweep: {robot.mass_kg: [" << masses << "]}\n";
    return (scratch / name).string();
  };
  const std::string few = sweep("few.yaml", "1.816, 2.4"), more = sweep("more.yaml", "1.5, 1.816, 2.4");
  const auto fly = [&](const std::string& file, int missions, const std::string& dir,
                       const std::string& options = "") {
    return Ed3r(
        fmt::format("run {} --missions {} --out {} {}", file, missions, (scratch / dir).string(), options));
  };
  ASSERT_EQ(fly(few, 6, "run").status, 0);
  const CommandResult grown = fly(few, 12, "run");
  EXPECT_EQ(grown.status, 0) << grown.err;
  EXPECT_NE(grown.out.find("grown: stage online: 12 missions per arm for 6\n"), std::string::npos)
      << grown.out;
  EXPECT_NE(grown.out.find("24 missions stored (12 before)"), std::string::npos) << grown.out;
  ASSERT_EQ(fly(few, 12, "fresh12").status, 0);
  EXPECT_EQ(Digest(scratch / "run"), Digest(scratch / "fresh12"));

  EXPECT_NE(fly(more, 12, "run").out.find("arms added: rbs,mass_kg=1.5\n"), std::string::npos);
  ASSERT_EQ(fly(more, 12, "fresh").status, 0);
  const std::string whole = Digest(scratch / "fresh");
  EXPECT_EQ(Digest(scratch / "run"), whole);
  EXPECT_EQ(Ed3r("replay " + (scratch / "run").string() + " rbs,mass_kg=2.4/3").status, 0);

  for (const char* shard : {"0/2", "1/2"}) {
    const std::string dir = std::string("shard") + shard[0], option = std::string("--quiet --shard ") + shard;
    ASSERT_EQ(fly(few, 6, dir, option).status, 0);
    ASSERT_EQ(fly(more, 12, dir, option).status, 0);
  }
  ASSERT_EQ(Ed3r(fmt::format("merge {0}/merged {0}/shard0 {0}/shard1", scratch.Path().string())).status, 0);
  EXPECT_EQ(Digest(scratch / "merged"), whole);

  const CommandResult lowered = fly(more, 11, "run"),
                      changed = fly(more, 12, "run", "--set robot.speed_mps=4");
  EXPECT_EQ(lowered.status, 2);
  EXPECT_NE(lowered.err.find("stage online has 12 missions per arm there and 11 here"), std::string::npos)
      << lowered.err;
  EXPECT_EQ(changed.status, 2);
  EXPECT_NE(changed.err.find("arm rbs,mass_kg=1.5: robot.speed_mps is 5 there and 4 here"), std::string::npos)
      << changed.err;
  EXPECT_EQ(Digest(scratch / "run"), whole);
}

TEST(RunTest, BadInputWritesNothing) {
  const ScratchFolder scratch;
  const std::string out = (scratch / "run").string();
  const std::pair<std::string, std::string> cases[] = {
      {"--set robot.mass_kg=-1",
       "--set robot.mass_kg=-1: robot.mass_kg: '-1' is not allowed; allowed: 0.05 .. 50 kg\n"},
      {"--set mission.strategy=rsb",
       "--set mission.strategy=rsb: mission.strategy: 'rsb' is not allowed; allowed: random | random-offload "
       "| rbs | ed3r | "
       "ablation-1 | ablation-2 | ablation-3 | ablation-4 | ecd2r | look-level | external; did you mean "
       "rbs?\n"},
      {"--missions 0", "--missions: '0' is not allowed; allowed: 1 .. 10000000\n"},
      {"--missions online=x", "--missions: 'x' is not allowed; allowed: 1 .. 10000000\n"},
      {"--missions =3", "--missions: '=3' is not allowed; allowed: N or STAGE=N\n"},
      {"--missions warmup=3", "--missions warmup=3: 'warmup' is not a stage that flies; allowed: online\n"},
      {"--seed x", "--seed: 'x' is not allowed; allowed: 0 .. 18446744073709551615\n"},
  };
  for (const auto& [arguments, message] : cases) {
    const CommandResult result = Ed3r(fmt::format("run {}rbs.yaml {} --out {}", kSweeps, arguments, out));
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.err, message);
    EXPECT_FALSE(fs::exists(out)) << arguments;
  }
  for (const char* arguments : {"--threads -1", "--shard 4/3", "--shard x", "--thread 2"}) {
    const CommandResult result = Ed3r(fmt::format("run {}rbs.yaml {} --out {}", kSweeps, arguments, out));
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(out)) << arguments;
  }
  EXPECT_EQ(Ed3r("run no-such.yaml --out " + out).status, 2);
  EXPECT_EQ(Ed3r("run " + kSweeps + "rbs.yaml --out " + out, "ED3R_SIMD=sse").status, 2);
  EXPECT_FALSE(fs::exists(out));
}

TEST(RunTest, ProfileTellsWhereTheTimeWentAndChangesNothing) {
  const ScratchFolder scratch;
  const std::string run = "run " + kSweeps + "rbs.yaml --missions 4 --quiet --out ";
  const std::string with = (scratch / "with").string(), without = (scratch / "without").string();
  const CommandResult told = Ed3r(run + with + " --profile");
  ASSERT_EQ(told.status, 0) << told.err;
  for (const char* word : {"time: ", "physics ", "control ", " thread seconds\n"})
    EXPECT_NE(told.out.find(word), std::string::npos) << told.out;
  ASSERT_EQ(Ed3r(run + without).status, 0);
  EXPECT_EQ(Ed3r("digest " + with).out, Ed3r("digest " + without).out);
  const std::string out = (scratch / "report").string();
  ASSERT_EQ(Ed3r("report " + with + " --no-figures --no-missions --out " + out).status, 0);
  const auto manifest = nlohmann::json::parse(ReadAll(fs::path(out) / "manifest.json"));
  EXPECT_NE(manifest["machine"]["time by phase"].get<std::string>().find("physics"), std::string::npos);
}

TEST(RunTest, PlanFliesNothing) {
  const CommandResult result = Ed3r("plan --json " + kSweeps + "paper.yaml");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto plan = nlohmann::json::parse(result.out);
  EXPECT_EQ(plan["missions"], 2 * 2040 + 9 * 850);
  EXPECT_EQ(plan["stages"][2]["arms"][1]["name"], "ed3r-75");
}

TEST(RunTest, ReportIsJsonWithIntervals) {
  const ScratchFolder scratch;
  Fly("rbs.yaml", "--missions 20", scratch / "run");
  const CommandResult result = Ed3r("report --json " + (scratch / "run").string());
  ASSERT_EQ(result.status, 0) << result.err;
  const auto rbs = nlohmann::json::parse(result.out).at("arms").at("rbs");
  EXPECT_EQ(rbs["missions"], 20);
  for (const char* metric : {"total_energy_kj",
                             "movement_energy_kj",
                             "computation_energy_kj",
                             "transmission_energy_kj",
                             "sensing_energy_kj",
                             "mscs_pct",
                             "msr_pct",
                             "wer_pct",
                             "fp_pct",
                             "bd_pct",
                             "or_pct",
                             "model_full_pct",
                             "model_quant_pct",
                             "lf_accuracy_pct",
                             "er_pct",
                             "duration_mean_min",
                             "duration_p85_min",
                             "duration_max_min",
                             "within_10min_pct",
                             "timesteps_mean",
                             "seconds_per_timestep",
                             "mean_power_w"})
    EXPECT_TRUE(rbs.contains(metric)) << metric;
  EXPECT_LE(rbs["total_energy_kj"]["lo"].get<double>(), rbs["total_energy_kj"]["mean"].get<double>());
  EXPECT_GE(rbs["total_energy_kj"]["hi"].get<double>(), rbs["total_energy_kj"]["mean"].get<double>());
}

}  // namespace
}  // namespace ed3r::app
