// Sweeps with more than one training stage: each learns from what is flown when it begins, and from nothing else.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "engine/core/files/csv_table.h"
#include "tests/app/command.h"

namespace ed3r::app {
namespace {

// A second warm-up is flown after the first networks have flown.
constexpr const char* kTwoTrainings =
    "name: two\n"
    "seed: 3\n"
    "missions: 6\n"
    "set: {{mission.world: {0}/sweeps/worlds/ridges.yaml, training.epochs: 2, training.batch: 32}}\n"
    "stages:\n"
    "  - {{name: walk, set: {{strategy: random}}}}\n"
    "  - {{name: learn-walk, kind: train, after: walk}}\n"
    "  - {{name: first, after: learn-walk, set: {{strategy: ed3r}}}}\n"
    "  - {{name: send, after: first, set: {{strategy: random-offload}}}}\n"
    "  - {{name: learn-send, kind: train, after: [send, learn-walk]}}\n"
    "  - {{name: second, after: {1}, sweep: {{strategy: [ecd2r, ablation-1]}}}}\n";

std::string Write(const ScratchFolder& scratch, const std::string& after) {
  const std::string file = (scratch / "two.yaml").string();
  std::ofstream(file) << fmt::format(fmt::runtime(kTwoTrainings), ED3R_SOURCE_DIR, after);
  return file;
}

TEST(TrainingTest, ALaterWarmUpIsNotLearnedFromBeforeItIsFlown) {
  const ScratchFolder scratch;
  const std::string sweep = Write(scratch, "learn-send");
  const std::string run = (scratch / "run").string();
  const std::string cache = (scratch / "cache").string();
  const CommandResult flown = Ed3r(fmt::format("run {} --quiet --out {} --cache {}", sweep, run, cache));
  ASSERT_EQ(flown.status, 0) << flown.err;
  const auto status = nlohmann::json::parse(Ed3r("status --json " + run).out);
  ASSERT_EQ(status["arms"].size(), 7u);
  for (const auto& arm : status["arms"]) EXPECT_EQ(arm["done"], arm["planned"]);
  EXPECT_EQ(Ed3r(fmt::format("replay {} second/ecd2r/3 --cache {}", run, cache)).status, 0);
  EXPECT_EQ(Ed3r(fmt::format("replay {} second/ablation-1/3 --cache {}", run, cache)).status, 0);
  EXPECT_EQ(Ed3r(fmt::format("replay {} first/ed3r-75/3 --cache {}", run, cache)).status, 0);

  // Continued by another process after the first stage: the same networks, the same missions.
  const std::string parts = fmt::format("run {} --quiet --out {} --cache {}", sweep, (scratch / "c").string(),
                                        (scratch / "cache2").string());
  ASSERT_EQ(Ed3r(parts + " --shard 1/2").status, 0);
  ASSERT_EQ(Ed3r(parts).status, 0);
  EXPECT_EQ(Ed3r("digest " + (scratch / "c").string()).out, Ed3r("digest " + run).out);
}

TEST(TrainingTest, AStageBeforeItsOwnNetworksIsRefused) {
  const ScratchFolder scratch;
  const std::string sweep = Write(scratch, "learn-send");
  const std::string run = (scratch / "run").string();
  const std::string parts =
      fmt::format("run {} --quiet --out {} --cache {} --stage ", sweep, run, (scratch / "cache").string());
  for (const char* stage : {"walk", "learn-walk", "first", "send"}) ASSERT_EQ(Ed3r(parts + stage).status, 0);
  const CommandResult early = Ed3r(parts + "second");  // the store holds networks, of the first stage
  EXPECT_EQ(early.status, 2);
  EXPECT_NE(early.err.find("holds no networks, which stage second asks"), std::string::npos) << early.err;
  EXPECT_EQ(Ed3r(parts + "learn-send").status, 0);
  EXPECT_EQ(Ed3r(parts + "second").status, 0);
}

// What is refused, whenever it is, leaves a run that its own sweep goes on with.
TEST(TrainingTest, ARunThatIsRefusedHasNotGrown) {
  const ScratchFolder scratch;
  const std::string sweep = Write(scratch, "learn-send");
  const std::string run = (scratch / "run").string(), part = (scratch / "part").string();
  const auto command = [&](const std::string& dir, const std::string& more) {
    return fmt::format("run {} --quiet --out {} --cache {} {}", sweep, dir, (scratch / "cache").string(),
                       more);
  };
  ASSERT_EQ(Ed3r(command(part, "--stage walk --shard 1/2")).status, 0);
  const CommandResult early = Ed3r(command(part, "--stage second --missions second=8"));
  EXPECT_EQ(early.status, 2);
  EXPECT_NE(early.err.find("holds no networks"), std::string::npos) << early.err;
  EXPECT_EQ(Ed3r(command(part, "--stage walk --shard 2/2")).status, 0);

  ASSERT_EQ(Ed3r(command(run, "")).status, 0);
  const std::string digest = Ed3r("digest " + run).out;
  std::filesystem::path network;
  for (const auto& file : std::filesystem::directory_iterator(scratch / "cache"))
    if (file.path().extension() == ".rfnn") network = file.path();
  std::filesystem::copy(network, scratch / "kept");
  std::ofstream(network) << "no network";
  EXPECT_EQ(Ed3r(command(run, "--missions second=8")).status, 2);
  EXPECT_EQ(Ed3r("digest " + run).out, digest);
  std::filesystem::copy(scratch / "kept", network, std::filesystem::copy_options::overwrite_existing);
  const CommandResult again = Ed3r(command(run, ""));
  EXPECT_EQ(again.status, 0) << again.err;
  ASSERT_EQ(Ed3r(command(run, "--missions second=8")).status, 0);
  ASSERT_EQ(Ed3r(command((scratch / "fresh").string(), "--missions second=8")).status, 0);
  EXPECT_EQ(Ed3r("digest " + run).out, Ed3r("digest " + (scratch / "fresh").string()).out);
}

TEST(TrainingTest, AWarmUpThatNoTrainingStageStandsBehindIsRefused) {
  const ScratchFolder scratch;
  const std::string sweep = Write(scratch, "[learn-walk, send]");  // ecd2r learns from send, after it
  const CommandResult result = Ed3r(fmt::format("run {} --out {}", sweep, (scratch / "run").string()));
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_NE(result.err.find("arm ecd2r asks networks"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "run"));
}

constexpr const char* kOwnWarmups =
    "name: own\n"
    "seed: 3\n"
    "set: {{mission.world: {0}/sweeps/worlds/ridges.yaml, training.epochs: 2, training.batch: 32}}\n"
    "stages:\n"
    "  - {{name: walk, missions: {1}, set: {{strategy: random}}}}\n"
    "  - {{name: learn, kind: train, after: walk}}\n"
    "  - {{name: online, missions: 56, after: learn, set: {{strategy: ablation-1, training.seeds: {2}, "
    "training.own_warmups: {3}}}}}\n";

// Flown into a folder of its own, with the networks of `cache`, whose number is returned.
int FlyOwn(const ScratchFolder& scratch, const std::string& name, int missions, int seeds, bool own,
           const std::string& cache) {
  const std::string sweep = (scratch / (name + ".yaml")).string();
  std::ofstream(sweep) << fmt::format(fmt::runtime(kOwnWarmups), ED3R_SOURCE_DIR, missions, seeds, own);
  const CommandResult flown = Ed3r(fmt::format("run {} --quiet --out {} --cache {}", sweep,
                                               (scratch / name).string(), (scratch / cache).string()));
  EXPECT_EQ(flown.status, 0) << flown.err;
  int networks = 0;
  for (const auto& file : std::filesystem::directory_iterator(scratch / cache))
    networks += file.path().extension() == ".rfnn" ? 1 : 0;
  return networks;
}

TEST(TrainingTest, EveryNetworkLearnsFromAWarmUpOfItsOwn) {
  const ScratchFolder scratch;
  EXPECT_EQ(FlyOwn(scratch, "own", 6, 2, true, "cache"), 2);
  // The first network knows the first three missions and nothing else: one that was trained on these alone is the same.
  EXPECT_EQ(FlyOwn(scratch, "alone", 3, 1, false, "cache"), 2);
  // Two that share all six are others.
  EXPECT_EQ(FlyOwn(scratch, "shared", 6, 2, false, "cache"), 4);
  // So is a second one that shares the first's missions: the own one has learned from others.
  EXPECT_EQ(FlyOwn(scratch, "few", 3, 2, false, "cache"), 5);

  const auto replays = [&](const std::string& run, int mission) {
    return Ed3r(fmt::format("replay {} ablation-1/{} --cache {}", (scratch / run).string(), mission,
                            (scratch / "cache").string()))
        .status;
  };
  EXPECT_EQ(replays("own", 0), 0);   // of the first network
  EXPECT_EQ(replays("own", 55), 0);  // and the second: 28 places in turn
}

TEST(TrainingTest, NetworksOfOneNameAreExportedIntoFilesOfTheirOwn) {
  const ScratchFolder scratch;
  const std::string sweep = (scratch / "epochs.yaml").string(), run = (scratch / "run").string();
  std::ofstream(sweep) << fmt::format(
      "name: epochs\nseed: 3\nmissions: 4\n"
      "set: {{mission.world: {0}/sweeps/worlds/ridges.yaml, training.batch: 32}}\n"
      "stages:\n"
      "  - {{name: walk, set: {{strategy: random}}}}\n"
      "  - {{name: learn, kind: train, after: walk}}\n"
      "  - name: online\n"
      "    after: learn\n"
      "    sweep:\n"
      "      list:\n"
      "        - {{name: short, strategy: ablation-1, training.epochs: 1}}\n"
      "        - {{name: long, strategy: ablation-1, training.epochs: 3}}\n",
      ED3R_SOURCE_DIR);
  const CommandResult flown =
      Ed3r(fmt::format("run {} --quiet --out {} --cache {}", sweep, run, (scratch / "cache").string()));
  ASSERT_EQ(flown.status, 0) << flown.err;
  const CommandResult exported =
      Ed3r(fmt::format("export {} --networks --out {}", run, (scratch / "out").string()));
  ASSERT_EQ(exported.status, 0) << exported.err;
  std::map<std::string, std::string> contents;
  for (const auto& file : std::filesystem::directory_iterator(scratch / "out"))
    if (file.path().extension() == ".onnx")
      contents.emplace(ReadAll(file.path()), file.path().filename().string());
  EXPECT_EQ(contents.size(), 2u);

  // Which is which.
  const std::string index = (scratch / "out" / "networks.csv").string();
  EXPECT_NE(exported.out.find(index + ": 2 rows"), std::string::npos) << exported.out;
  const CsvTable table = CsvTable::Read(index);
  ASSERT_EQ(table.rows(), 2u);
  std::set<std::string> files, arms;
  for (std::size_t row = 0; row < 2; ++row) {
    const auto cell = [&](std::string_view column) { return table.Text(row, table.Column(column, "")); };
    files.insert(cell("file"));
    arms.insert(cell("arm"));
    EXPECT_NE(cell("file").find(cell("sha256").substr(0, 12)), std::string::npos);
    EXPECT_EQ(cell("stage") + " " + cell("agent"), "online rc");
    EXPECT_EQ(cell("training_seed") + " " + cell("network"), "1 0");
    EXPECT_EQ(std::filesystem::exists(scratch / "out" / cell("file")), true);
  }
  EXPECT_EQ(files.size(), 2u);
  EXPECT_EQ(arms, (std::set<std::string>{"short", "long"}));
}

TEST(TrainingTest, AWarmUpThatIsTooShortForItsNetworksIsRefused) {
  const ScratchFolder scratch;
  const std::string sweep = (scratch / "own.yaml").string();
  std::ofstream(sweep) << fmt::format(fmt::runtime(kOwnWarmups), ED3R_SOURCE_DIR, 5, 2, true);
  const CommandResult result = Ed3r(fmt::format("run {} --out {}", sweep, (scratch / "run").string()));
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_NE(result.err.find("stage walk has 5 missions to share out, allowed: 3 for each network and more; "
                            "'--missions walk=6'"),
            std::string::npos)
      << result.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "run"));
}

}  // namespace
}  // namespace ed3r::app
