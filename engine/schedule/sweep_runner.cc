#include "engine/schedule/sweep_runner.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/agents/strategy.h"
#include "engine/core/check.h"
#include "engine/core/version.h"
#include "engine/mission/mission.h"
#include "engine/mission/scenario.h"
#include "engine/robot/airframe.h"
#include "engine/store/store.h"

namespace ed3r {
namespace {

void CheckArm(const Arm& arm, const Scene& scene, std::uint64_t seed) {
  FindStrategy(arm.config.mission.strategy);
  DealScenario(scene, arm.config.mission, seed, 0);
  CheckFlyable(arm.config);
}

Recipe RecipeOf(const SweepPlan& plan, const Worlds& worlds,
                const std::map<std::string, std::string>& notes) {
  Recipe recipe;
  recipe.plan_text = plan.CanonicalText();
  recipe.code_version = ThisCode().source_hash;
  for (const Stage& stage : plan.stages)
    for (const Arm& arm : stage.arms)
      recipe.worlds[arm.world] = worlds.at(arm.config.mission.world)->Fingerprint();
  recipe.notes = notes;
  return recipe;
}

void Add(const RunSummary& part, RunSummary& sum) {
  sum.stored += part.stored;
  sum.failed += part.failed;
  sum.dropped += part.dropped;
  sum.interrupted = sum.interrupted || part.interrupted;
  sum.threads = part.threads;
  sum.wall_s += part.wall_s;
  sum.simulated_s += part.simulated_s;
}

// Missions of a stage that are stored; `stored` is sorted.
std::int64_t StoredOfStage(const std::vector<RunId>& stored, int stage) {
  return std::count_if(stored.begin(), stored.end(), [stage](const RunId& id) { return id.stage == stage; });
}

bool Complete(const SweepPlan& plan, const std::vector<RunId>& stored, const std::string& stage_name) {
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const Stage& stage = plan.stages[i];
    if (stage.name != stage_name) continue;
    return StoredOfStage(stored, static_cast<int>(i)) ==
           static_cast<std::int64_t>(stage.arms.size()) * stage.missions;
  }
  throw InternalError("a stage waits for '" + stage_name + "', which the plan does not have");
}

}  // namespace

Worlds LoadWorlds(const SweepPlan& plan) {
  CheckTraining(plan);
  Worlds worlds;
  for (const Stage& stage : plan.stages) {
    for (const Arm& arm : stage.arms) {
      std::shared_ptr<const Scene>& scene = worlds[arm.config.mission.world];
      if (!scene) scene = Scene::Load(arm.config.mission.world);
      try {
        CheckArm(arm, *scene, plan.seed);
      } catch (const UserError& error) {
        throw UserError(fmt::format("{}: arm {}: {}", plan.file, arm.name, error.what()));
      }
    }
  }
  return worlds;
}

MissionTask TaskOf(const SweepPlan& plan, const Worlds& worlds, const NetworkShelf* networks,
                   const RunId& id) {
  const Arm& arm =
      plan.stages.at(static_cast<std::size_t>(id.stage)).arms.at(static_cast<std::size_t>(id.arm));
  const Scene& scene = *worlds.at(arm.config.mission.world);
  MissionTask task{.scene = scene, .config = arm.config, .seed = plan.seed};
  task.scenario = static_cast<std::uint32_t>(arm.config.mission.first_scenario + id.mission);
  task.mission = id.mission;
  if (networks != nullptr) {
    const int places = PlacesInPlay(scene, arm.config.mission);
    task.networks = networks->For(id, places);
    task.network_seed = networks->SeedIndex(id, places);
  }
  return task;
}

namespace {

// One run of the stages of a plan.
class Stages {
 public:
  Stages(const SweepPlan& plan, const Worlds& worlds, const SweepOptions& options)
      : plan_(plan),
        worlds_(worlds),
        options_(options),
        layout_(LayoutOf(plan)),
        store_(ResultStore::Open(options.dir, RecipeOf(plan, worlds, options.notes), layout_)) {
    summary_.stored_before = static_cast<std::int64_t>(store_->Stored().size());
  }

  SweepSummary Run() {
    for (std::size_t i = 0; i < plan_.stages.size() && !summary_.flown.interrupted; ++i) {
      const std::vector<RunId> stored = store_->Stored();
      if (!Ready(plan_.stages[i], stored)) {
        summary_.waiting_stage = plan_.stages[i].name;
        break;
      }
      plan_.stages[i].kind == StageKind::kTrain ? Train() : Fly(static_cast<int>(i), stored);
    }
    return std::move(summary_);
  }

 private:
  bool Ready(const Stage& stage, const std::vector<RunId>& stored) const {
    return std::all_of(stage.after.begin(), stage.after.end(),
                       [&](const std::string& name) { return Complete(plan_, stored, name); });
  }

  void Fly(int stage, const std::vector<RunId>& stored) {
    ScheduleOptions schedule = options_.schedule;
    schedule.label = plan_.stages[static_cast<std::size_t>(stage)].name;
    schedule.stored_before = StoredOfStage(stored, stage);
    const FlyFn fly = [&](const RunId& id, const std::atomic<bool>& stop) {
      MissionTask task = TaskOf(plan_, worlds_, networks_.get(), id);
      task.stop = &stop;
      return FlyMission(task);
    };
    Add(RunMissions(Todo(layout_, stage, options_.shard, stored), fly, *store_, schedule), summary_.flown);
  }

  void Train() {
    store_->Commit();
    networks_ =
        TrainNetworks(plan_, {options_.dir, options_.cache_dir, ThreadsFor(options_.schedule.threads),
                              options_.schedule.stop, options_.schedule.progress, options_.schedule.quiet});
    if (networks_ == nullptr)
      summary_.flown.interrupted = true;
    else
      summary_.networks = networks_->All();
  }

  const SweepPlan& plan_;
  const Worlds& worlds_;
  const SweepOptions& options_;
  const RunLayout layout_;
  const std::unique_ptr<ResultStore> store_;
  std::unique_ptr<NetworkShelf> networks_;
  SweepSummary summary_;
};

}  // namespace

SweepSummary RunSweep(const SweepPlan& plan, const Worlds& worlds, const SweepOptions& options) {
  return Stages(plan, worlds, options).Run();
}

}  // namespace ed3r
