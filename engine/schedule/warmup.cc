#include "engine/schedule/warmup.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/agents/strategy.h"
#include "engine/core/check.h"
#include "engine/sweep/setting.h"

namespace ed3r::schedule {
namespace {

constexpr int kFewestMissions = 3;  // one each to train, validate and test on

// Stages that `stage` builds on, directly or not.
std::set<std::string> Foundations(const sweep::SweepPlan& plan, const sweep::Stage& stage) {
  std::set<std::string> found(stage.after.begin(), stage.after.end());
  for (auto it = plan.stages.rbegin(); it != plan.stages.rend();
       ++it)  // a stage stands behind those it builds on
    if (found.contains(it->name)) found.insert(it->after.begin(), it->after.end());
  return found;
}

std::string_view SourceOf(const sweep::Arm& learner) {
  return agents::FindStrategy(learner.config.mission.strategy).networks;
}

// Training stages among `foundations` that come after the flying stage of this name.
std::set<std::string> TrainingsBehind(const sweep::SweepPlan& plan, const std::set<std::string>& foundations,
                                      const std::string& flown) {
  std::set<std::string> trainings;
  for (const sweep::Stage& stage : plan.stages)
    if (stage.kind == sweep::StageKind::kTrain && foundations.contains(stage.name) &&
        Foundations(plan, stage).contains(flown))
      trainings.insert(stage.name);
  return trainings;
}

// Strategies that would ask the RC's network alone, or with `robot` the robot's alone, of the same training.
std::string StrategiesThatAsk(const agents::Strategy& both, bool robot) {
  std::vector<std::string_view> names;
  for (const agents::Strategy& other : agents::Strategies())
    if (other.networks == both.networks && other.motion.asks_network != robot &&
        other.execution.asks_network == robot)
      names.push_back(other.name);
  return names.empty() ? ""
                       : fmt::format(", a strategy that asks no such network ({})", fmt::join(names, " | "));
}

// Of an arm that asks networks where nothing trains them: which ones, and what would give them.
std::string WhatIsMissing(const sweep::Arm& learner) {
  const agents::Strategy& strategy = agents::FindStrategy(learner.config.mission.strategy);
  const auto lacks = [](bool asked, const char* key, const std::string& file) {
    return asked && file == sweep::FileNotNeeded(key);
  };
  const bool rc = lacks(strategy.motion.asks_network, "networks.rc", learner.config.networks.rc);
  const bool robot = lacks(strategy.execution.asks_network, "networks.robot", learner.config.networks.robot);
  const std::string training = fmt::format(
      "a training stage ('kind: train') that comes after a stage with strategy {}", SourceOf(learner));
  const bool both_asked = strategy.motion.asks_network && strategy.execution.asks_network;
  if (rc == robot || !both_asked)
    return fmt::format("asks networks, so the stage must come after {}; or give {}", training,
                       both_asked ? "networks.rc and networks.robot"
                       : rc       ? "networks.rc"
                                  : "networks.robot");
  const char* missing = rc ? "networks.rc" : "networks.robot";
  return fmt::format(
      "has {} from a file, but strategy {} asks the {} network too, and nothing trains it; "
      "allowed: {}: FILE.onnx{}, or, before this stage, {}",
      rc ? "networks.robot" : "networks.rc", strategy.name, rc ? "RC's" : "robot's", missing,
      StrategiesThatAsk(strategy, rc), training);
}

}  // namespace

namespace {

// Every warm-up that the learner could learn from, in the plan's order.
std::vector<WarmupChoice> Warmups(const sweep::SweepPlan& plan, const sweep::Stage& stage,
                                  const sweep::Arm& learner) {
  std::vector<WarmupChoice> found;
  const std::set<std::string> foundations = Foundations(plan, stage);
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    const sweep::Stage& flown = plan.stages[s];
    if (flown.kind != sweep::StageKind::kFly || !foundations.contains(flown.name)) continue;
    const std::set<std::string> trainings = TrainingsBehind(plan, foundations, flown.name);
    if (trainings.empty()) continue;
    for (std::size_t a = 0; a < flown.arms.size(); ++a)
      if (flown.arms[a].config.mission.strategy == SourceOf(learner) &&
          flown.arms[a].variant == learner.variant)
        found.push_back({static_cast<int>(s), static_cast<int>(a), trainings});
  }
  return found;
}

std::string NameOf(const sweep::SweepPlan& plan, const WarmupChoice& warmup) {
  const sweep::Stage& stage = plan.stages[static_cast<std::size_t>(warmup.stage)];
  return fmt::format("arm {} of stage {}", stage.arms[static_cast<std::size_t>(warmup.arm)].name, stage.name);
}

}  // namespace

WarmupChoice ChooseWarmup(const sweep::SweepPlan& plan, const sweep::Stage& stage,
                          const sweep::Arm& learner) {
  std::vector<WarmupChoice> warmups = Warmups(plan, stage, learner);
  return warmups.empty() ? WarmupChoice{} : std::move(warmups.front());
}

WarmupPart PartOf(const sweep::SweepPlan& plan, const WarmupChoice& warmup, const TrainingConfig& training,
                  int seed) {
  const int missions = plan.stages[static_cast<std::size_t>(warmup.stage)].missions;
  if (!training.own_warmups) return {warmup.stage, warmup.arm, 0, missions};
  const int share = missions / training.seeds;
  return {warmup.stage, warmup.arm, seed * share, (seed + 1) * share};
}

void CheckWarmup(const sweep::SweepPlan& plan, const sweep::Stage& stage, const sweep::Arm& learner) {
  const WarmupChoice choice = ChooseWarmup(plan, stage, learner);
  const std::string who = fmt::format("{}: stage {}: arm {}", plan.file, stage.name, learner.name);
  if (!choice) throw UserError(fmt::format("{} {}", who, WhatIsMissing(learner)));
  if (const std::vector<WarmupChoice> all = Warmups(plan, stage, learner); all.size() > 1)
    throw UserError(
        fmt::format("{} could learn from {} and from {}; allowed: one warm-up of strategy {} before it; axes "
                    "at the top of the file make variants, "
                    "each with its own",
                    who, NameOf(plan, all[0]), NameOf(plan, all[1]), SourceOf(learner)));
  const sweep::Stage& warmup = plan.stages[static_cast<std::size_t>(choice.stage)];
  const TrainingConfig& training = learner.config.training;
  if (!training.own_warmups) return;
  if (warmup.missions / training.seeds < kFewestMissions)
    throw UserError(
        fmt::format("{} asks {} networks of each kind (training.seeds) with a warm-up of their own "
                    "(training.own_warmups), but stage {} has {} missions to share out, allowed: {} for each "
                    "network and more; '--missions {}={}' gives them",
                    who, training.seeds, warmup.name, warmup.missions, kFewestMissions, warmup.name,
                    kFewestMissions * training.seeds));
  if (warmup.precision)
    throw UserError(
        fmt::format("{} shares stage {} out among its networks (training.own_warmups), so that stage cannot "
                    "end by a precision; leave one of the two out",
                    who, warmup.name));
}

}  // namespace ed3r::schedule
