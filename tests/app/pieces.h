// A sweep in the pieces that a batch system flies, without one: the commands of the batch scripts, by hand.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/app/command.h"

namespace ed3r::app {

inline const std::string kWorld = "mission.world: " ED3R_SOURCE_DIR "/sweeps/worlds/ridges.yaml";

inline const std::string kStages =
    "set: {training.learning_rate: 1e-4, training.epochs: 2, robot.battery_mah: 400, " + kWorld + R"(}
name: pieces
seed: 3
stages:
  - {name: warmup, missions: 12, set: {strategy: random}}
  - {name: training, kind: train, after: warmup}
  - {name: online, after: training, missions: 5, set: {strategy: ed3r}}
)";

class PiecesTest : public testing::Test {
 protected:
  std::string Write(const std::string& text) {
    const std::string file = (scratch_ / "sweep.yaml").string();
    std::ofstream(file) << text << "\n";
    return file;
  }
  std::string Run() const { return (scratch_ / "run").string(); }
  std::string Cache() const { return (scratch_ / "cache").string(); }

  CommandResult Piece(const std::string& sweep, const std::string& stage, const std::string& shard) {
    return Ed3r(fmt::format("run {} --stage {} --shard {} --from {} --out {}/shards/{}/{} --cache {} --quiet",
                            sweep, stage, shard, Run(), Run(), stage, shard.substr(0, 1), Cache()));
  }
  void ExpectDone(const CommandResult& result) { EXPECT_EQ(result.status, 0) << result.err; }
  void Merge(const std::string& stage) {
    ExpectDone(Ed3r(fmt::format("merge {} {}/shards/{}/*/", Run(), Run(), stage)));
  }
  std::string Missing(const std::string& sweep) {
    const CommandResult result =
        Ed3r(fmt::format("slurm {} --out {} --cache {} --missing", sweep, Run(), Cache()));
    ExpectDone(result);
    return result.out;
  }
  bool Says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

  ScratchFolder scratch_;
};

}  // namespace ed3r::app
