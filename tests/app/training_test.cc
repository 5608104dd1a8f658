// Sweeps with more than one training stage: each learns from what is flown when it begins, and from nothing else.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/app/command.h"

namespace ed3r {
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

TEST(TrainingTest, AWarmUpThatNoTrainingStageStandsBehindIsRefused) {
  const ScratchFolder scratch;
  const std::string sweep = Write(scratch, "[learn-walk, send]");  // ecd2r learns from send, after it
  const CommandResult result = Ed3r(fmt::format("run {} --out {}", sweep, (scratch / "run").string()));
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_NE(result.err.find("arm ecd2r asks networks"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "run"));
}

}  // namespace
}  // namespace ed3r
