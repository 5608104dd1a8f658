// Sweeps that stop when they know enough.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

// Two arms: with the smaller battery energies spread less, so that arm is known sooner.
std::string WriteSweep(const ScratchFolder& scratch, const std::string& precision) {
  const std::string file = (scratch / "precise.yaml").string();
  std::ofstream(file) << "name: precise\nmissions: 60\nprecision: " << precision
                      << "\nset: {strategy: rbs, mission.world: " << ED3R_SOURCE_DIR
                      << "/sweeps/worlds/ridges.yaml}\nsweep: {robot.battery_mah: [400, 3500]}\n";
  return file;
}

nlohmann::json ArmsOf(const fs::path& dir) {
  const CommandResult result = Ed3r("report --json --no-figures " + dir.string());
  EXPECT_EQ(result.status, 0) << result.err;
  return nlohmann::json::parse(result.out).at("arms");
}

TEST(PrecisionTest, ArmsStopOnTheirOwnAndTheSameHoweverFlown) {
  const ScratchFolder scratch;
  const std::string sweep = WriteSweep(scratch, "{metric: total_energy_kj, half_width: 2, every: 20}");
  std::string digests[2];
  for (const int threads : {1, 2}) {
    const std::string out = (scratch / fmt::format("{}", threads)).string();
    const CommandResult run = Ed3r(fmt::format("run {} --quiet --threads {} --out {}", sweep, threads, out));
    ASSERT_EQ(run.status, 0) << run.err;
    digests[threads - 1] = Ed3r("digest " + out).out;
  }
  EXPECT_EQ(digests[0], digests[1]);
  const nlohmann::json arms = ArmsOf(scratch / "1");
  const auto& small = arms.at("rbs,battery_mah=400");
  const auto& large = arms.at("rbs,battery_mah=3500");
  EXPECT_LT(small.at("missions"), 60);
  EXPECT_EQ(small.at("missions").get<int>() % 20, 0);
  EXPECT_EQ(small.at("missing"), 0);
  const auto& energy = small.at("total_energy_kj");
  EXPECT_LE(energy.at("hi").get<double>() - energy.at("lo").get<double>(), 4.0);
  EXPECT_EQ(large.at("missions"), 60) << "its energies spread over tens of kJ";

  const std::string again = (scratch / "1").string();
  ASSERT_EQ(Ed3r(fmt::format("run {} --quiet --out {}", sweep, again)).status, 0);
  EXPECT_EQ(Ed3r("digest " + again).out, digests[0]) << "the same command again flies nothing";
}

// Its round is over: what is taken out of it is not flown again.
TEST(PrecisionTest, APartIsNotRepaired) {
  const ScratchFolder scratch;
  const std::string sweep = WriteSweep(scratch, "{metric: total_energy_kj, half_width: 2, every: 20}");
  const std::string part = (scratch / "part").string();
  const std::string fly = fmt::format("run {} --stage online --shard 1/2 --from {} --quiet --out {}", sweep,
                                      (scratch / "whole").string(), part);
  ASSERT_EQ(Ed3r(fly).status, 0);
  const std::string damage = fmt::format(
      "/usr/bin/python3 -c \"import sqlite3; d = sqlite3.connect('{}/results.sqlite'); d.execute('UPDATE "
      "missions "
      "SET total_j = 1 WHERE mission = (SELECT min(mission) FROM missions)'); d.commit()\"",
      part);
  ASSERT_EQ(std::system(damage.c_str()), 0);
  const auto arms = nlohmann::json::parse(Ed3r("status --json " + part).out)["arms"];
  const CommandResult refused = Ed3r(fly + " --repair");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("--repair takes out only what the same call flies again"), std::string::npos)
      << refused.err;
  EXPECT_EQ(nlohmann::json::parse(Ed3r("status --json " + part).out)["arms"], arms);
}

TEST(PrecisionTest, WhatCannotBeIsRefused) {
  const ScratchFolder scratch;
  const auto refusal = [&](const std::string& precision, const std::string& arguments = "") {
    const std::string out = (scratch / "refused").string();
    const CommandResult result =
        Ed3r(fmt::format("run {} --quiet --out {} {}", WriteSweep(scratch, precision), out, arguments));
    EXPECT_EQ(result.status, 2);
    EXPECT_FALSE(fs::exists(out));
    return result.err;
  };
  EXPECT_NE(
      refusal("{metric: msr_pc, half_width: 1}").find("precise.yaml:3:21: metric: 'msr_pc' is not allowed"),
      std::string::npos);
  EXPECT_NE(refusal("{metric: msr_pc, half_width: 1}").find("did you mean msr_pct?"), std::string::npos);
  EXPECT_NE(refusal("{metric: msr_pct, half_width: 0}").find("half_width: '0' is not allowed"),
            std::string::npos);
  EXPECT_NE(refusal("{metric: msr_pct}").find("precision: needs metric and half_width"), std::string::npos);
  EXPECT_NE(refusal("{metric: msr_pct, half_width: 1}", "--shard 1/2").find("fly it without --shard"),
            std::string::npos);
}

}  // namespace
}  // namespace ed3r::app
