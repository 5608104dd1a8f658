#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "engine/app/commands.h"
#include "engine/app/expected_time.h"
#include "engine/app/idle_settings.h"
#include "engine/app/sweep_arguments.h"
#include "engine/app/words.h"
#include "engine/schedule/inputs.h"
#include "kernels/simd_level.h"

namespace ed3r::app {
namespace {

struct Options {
  SweepArguments sweep;
  std::int64_t shards = 0;  // 0: not asked
  bool json = false;
};

double ExpectedWallS(const sweep::Stage& stage, int threads) { return ExpectedCoreS(stage) / threads; }

void PrintJson(const sweep::SweepPlan& plan, int threads, std::int64_t shards) {
  nlohmann::ordered_json object = {{"name", plan.name},
                                   {"question", plan.question},
                                   {"seed", plan.seed},
                                   {"missions", plan.Missions()},
                                   {"notes", IdleSettings(plan)}};
  for (const sweep::Stage& stage : plan.stages) {
    nlohmann::ordered_json arms = nlohmann::ordered_json::array();
    for (const sweep::Arm& arm : stage.arms) {
      nlohmann::ordered_json settings = nlohmann::ordered_json::object();
      for (const auto& [key, value] : arm.settings) settings[key] = value;
      arms.push_back({{"name", arm.name}, {"settings", settings}});
    }
    object["stages"].push_back({{"name", stage.name},
                                {"kind", stage.kind == sweep::StageKind::kTrain ? "train" : "fly"},
                                {"after", stage.after},
                                {"missions_per_arm", stage.missions},
                                {"timesteps", NameOf(stage.timesteps)},
                                {"expected_s", ExpectedWallS(stage, threads)},
                                {"arms", arms}});
    if (shards == 0 || stage.kind != sweep::StageKind::kFly) continue;
    const ExpectedShards expected = ExpectedShardsOf(stage, shards);
    object["stages"].back()["shards"] = {{"tasks", expected.tasks},
                                         {"missions", expected.missions},
                                         {"expected_core_s", expected.core_s},
                                         {"longest_over_mean", expected.longest_over_mean}};
  }
  fmt::print("{}\n", object.dump(2));
}

std::string TrainingText(const sweep::SweepPlan& plan, int threads) {
  const ExpectedTraining expected = ExpectedTrainingOf(plan);
  if (expected.networks == 0) return "trains the networks that later stages ask for";
  const double side_by_side = std::min<double>(threads, static_cast<double>(expected.networks));
  return fmt::format("trains {}, at most about {:.1f} min on {}", Counted(expected.networks, "network"),
                     expected.core_s * static_cast<double>(expected.networks) / side_by_side / 60.0,
                     Counted(threads, "thread"));
}

std::string ShardsText(const sweep::Stage& stage, std::int64_t shards) {
  const ExpectedShards expected = ExpectedShardsOf(stage, shards);
  return fmt::format(
      "  in {}: {:.0f} missions and about {:.1f} core minutes each, the longest about {:.2f} times the "
      "mean\n",
      Counted(expected.tasks, "shard"), expected.missions, expected.core_s / 60, expected.longest_over_mean);
}

void PrintText(const sweep::SweepPlan& plan, int threads, std::int64_t shards) {
  fmt::print("{}: {}\nseed {}, {}\n", plan.name, plan.question, plan.seed,
             Counted(plan.Missions(), "mission"));
  for (const sweep::Stage& stage : plan.stages) {
    fmt::print("\nstage {}", stage.name);
    for (std::size_t i = 0; i < stage.after.size(); ++i)
      fmt::print("{}{}", i == 0 ? " after " : ", ", stage.after[i]);
    if (stage.kind == sweep::StageKind::kTrain) {
      fmt::print(": {}, unless the cache holds them\n", TrainingText(plan, threads));
      continue;
    }
    fmt::print(
        ": {} x {}, about {:.1f} min on {}\n", Counted(static_cast<std::int64_t>(stage.arms.size()), "arm"),
        Counted(stage.missions, "mission"), ExpectedWallS(stage, threads) / 60.0, Counted(threads, "thread"));
    if (stage.precision)
      fmt::print("  at most: an arm ends when {} is known to {}, looked at every {}\n",
                 stage.precision->metric, stage.precision->half_width,
                 Counted(stage.precision->every, "mission"));
    if (shards > 0) fmt::print("{}", ShardsText(stage, shards));
    if (stage.timesteps != sweep::KeptTimesteps::kAll)
      fmt::print("  stores timesteps of {} missions\n",
                 stage.timesteps == sweep::KeptTimesteps::kNone ? "no" : "failed");
    for (const sweep::Arm& arm : stage.arms) {
      std::string settings;
      for (const auto& [key, value] : arm.settings) settings += fmt::format("  {}={}", key, value);
      fmt::print("  {:<14}{}\n", arm.name, settings);
    }
  }
  const std::vector<std::string> idle = IdleSettings(plan);
  if (!idle.empty()) fmt::print("\n");
  for (const std::string& sentence : idle) fmt::print("note: {}\n", sentence);
}

}  // namespace

Command AddPlan(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser =
      program.AddCommand("plan", "Stages, arms, missions and expected time of a sweep; flies nothing");
  options->sweep.AddTo(parser);
  parser
      .Option("--shards", options->shards,
              "Also what this many tasks of a cluster do each, and how far apart they end")
      .Range(1, 100'000);
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] {
            kernels::ActiveSimdLevel();  // what 'ed3r run' would refuse
            const sweep::SweepPlan plan = options->sweep.Load();
            schedule::CheckPlan(plan);
            const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
            options->json ? PrintJson(plan, threads, options->shards)
                          : PrintText(plan, threads, options->shards);
            return kDone;
          }};
}

}  // namespace ed3r::app
