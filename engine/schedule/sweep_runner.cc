#include "engine/schedule/sweep_runner.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>

#include "engine/agents/strategy.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/temporary_file.h"
#include "engine/core/math_library.h"
#include "engine/core/suggest.h"
#include "engine/core/version.h"
#include "engine/mission/mission.h"
#include "engine/mission/scenario.h"
#include "engine/schedule/input_files.h"
#include "engine/schedule/progress_of_stage.h"
#include "engine/schedule/recorder.h"
#include "engine/store/growth.h"
#include "engine/store/part_of_run.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/store.h"

namespace ed3r::schedule {
namespace {

bool IsOutside(const sweep::Arm& arm) { return agents::FindStrategy(arm.config.mission.strategy).outside; }

store::Recipe RecipeOf(const sweep::SweepPlan& plan, const Inputs& inputs, const SweepOptions& options) {
  InputFiles files = inputs.Files(plan);
  store::CodeIdentities code = CodeOf(plan);
  if (!options.outside_identity.empty()) code["policy"] = {options.outside_identity};
  return {.plan_text = plan.CanonicalText(),
          .code = std::move(code),
          .inputs = inputs.Fingerprints(plan),
          .places = std::move(files.places),
          .files = std::move(files.files),
          .notes = options.notes};
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
std::int64_t StoredOfStage(const std::vector<sweep::RunId>& stored, int stage) {
  return std::count_if(stored.begin(), stored.end(),
                       [stage](const sweep::RunId& id) { return id.stage == stage; });
}

void CheckStageName(const sweep::SweepPlan& plan, const std::string& name) {
  std::vector<std::string> names;
  for (const sweep::Stage& stage : plan.stages) names.push_back(stage.name);
  if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) return;
  const std::string near = NearestWord(name, names);
  throw UserError(fmt::format("{}: no stage '{}'; allowed: {}{}", plan.file, name, fmt::join(names, ", "),
                              near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

}  // namespace

store::CodeIdentities CodeOf(const sweep::SweepPlan& plan) {
  const CodeVersion code = ThisCode();
  store::CodeIdentities identities = {{"flight", {code.flight}},
                                      {store::kMathLibrary, {MathLibraryIdentity()}}};
  if (NeedsNetworks(plan)) identities["training"] = {code.training};
  for (const sweep::Stage& stage : plan.stages) {
    if (stage.precision) identities["precision"] = {code.precision};
    for (const sweep::Arm& arm : stage.arms)
      if (arm.config.perception.tier == PerceptionTier::kPixels) identities["pixels"] = {code.pixels};
  }
  return identities;
}

void RefuseOtherCode(const std::string& dir, const store::CodeIdentities& there,
                     const store::CodeIdentities& here) {
  if (const auto difference = store::CodeDifference(there, here))
    throw UserError(fmt::format(
        "{}: holds results of another recipe: {}; give another --from, or --accept-mixed to build "
        "on what other code has made",
        dir, *difference));
}

mission::MissionTask TaskOf(const sweep::SweepPlan& plan, const Inputs& inputs, const NetworkShelf* networks,
                            const sweep::RunId& id) {
  const sweep::Arm& arm =
      plan.stages.at(static_cast<std::size_t>(id.stage)).arms.at(static_cast<std::size_t>(id.arm));
  const world::Scene& scene = inputs.SceneOf(arm.config);
  mission::MissionTask task{.scene = scene, .config = arm.config, .seed = plan.seed};
  task.pixels = inputs.PixelsOf(arm.config);
  task.scenario = static_cast<std::uint32_t>(arm.config.mission.first_scenario + id.mission);
  task.mission = id.mission;
  if (networks != nullptr) {
    const int places = mission::PlacesInPlay(scene, arm.config.mission);
    task.networks = networks->For(id, places);
    task.network_seed = networks->SeedIndex(id, places);
  }
  const agents::Networks own = inputs.NetworksOf(arm.config);
  if (own.rc != nullptr) task.networks.rc = own.rc;
  if (own.robot != nullptr) task.networks.robot = own.robot;
  task.networks.direct_rc = own.direct_rc;
  task.networks.direct_robot = own.direct_robot;
  return task;
}

namespace {

// One run of the stages of a plan.
class SweepRun {
 public:
  SweepRun(const sweep::SweepPlan& plan, const Inputs& inputs, const SweepOptions& options)
      : plan_(plan),
        inputs_(inputs),
        options_(options),
        layout_(store::LayoutOf(plan)),
        recipe_(RecipeOf(plan, inputs, options)) {
    store::Recipe with_foundation = recipe_;
    store::Join(with_foundation.code, CheckedFoundation());  // what is refused has repaired nothing
    store_ = store::ResultStore::Open(
        options.dir, with_foundation, layout_,
        {.other_code = options.accept_mixed ? store::OtherCode::kAccept : store::OtherCode::kRefuse,
         .repair = !options.repair ? store::Repair::kNo
                   : FliesAll()    ? store::Repair::kYes
                                   : store::Repair::kOfAPart,
         .may_grow = !options.only_failed});
    RemoveLeftovers(options.dir);
    RemoveLeftovers(options.cache_dir);
    LookForDamage();
    summary_.stored_before = static_cast<std::int64_t>(store_->Stored().size());
  }

  SweepSummary Run() {
    const WatchedThread watched;
    std::optional<PhaseSampler> sampler;
    try {
      if (options_.profile) sampler.emplace();
      RunStages();
      // What was interrupted before it put anything has the plan of before.
      if (!summary_.flown.interrupted) store_->Grow();
      if (store_->HasGrown()) summary_.grown = store_->Grown();
    } catch (...) {  // an empty store would look like a task that has begun
      store_->DiscardUnused();
      throw;
    }
    if (sampler) {
      summary_.profile = sampler->Finish();
      store_->PutNote(store::kProfileNote, summary_.profile.Text());
      store_->Commit();
    }
    return std::move(summary_);
  }

 private:
  void RunStages() {
    CheckStageIsReady();
    if (options_.only_failed) again_ = store_->Failed();
    for (std::size_t i = 0; i < plan_.stages.size() && !summary_.flown.interrupted; ++i) {
      if (!options_.stage.empty() && plan_.stages[i].name != options_.stage) continue;
      if (options_.only_failed && !AnyAgainFrom(static_cast<int>(i))) break;
      if (!Ready(plan_.stages[i])) {
        summary_.waiting_stage = plan_.stages[i].name;
        break;
      }
      plan_.stages[i].kind == sweep::StageKind::kTrain ? Train(plan_.stages[i].name)
                                                       : Fly(static_cast<int>(i));
    }
  }

  // A stage that builds on nothing may be of a plan that has grown since the foundation was merged last.
  void CheckStageIsReady() const {
    for (const sweep::Stage& stage : plan_.stages)
      if (stage.name == options_.stage && !stage.after.empty())
        CheckReady(plan_, stage, Foundation(), FoundationDir(), options_.half_width);
  }

  bool FliesAll() const {
    return options_.stage.empty() && options_.shard.count == 1 && !options_.only_failed;
  }

  // Once it is out: a mission that networks have learned from would be missing unseen, a round of a precision that is over is
  // not flown again, and a stage that waits is not flown (one that is named has been looked at).
  bool FliesAgain(const std::optional<sweep::RunId>& id) const {
    if (FliesAll()) return true;
    if (!id || options_.only_failed || !InShard(layout_.LinearIndex(*id), options_.shard)) return false;
    const sweep::Stage& stage = plan_.stages[static_cast<std::size_t>(id->stage)];
    return !stage.precision && (stage.name == options_.stage || (options_.stage.empty() && Ready(stage)));
  }

  // Nothing is built on damaged missions, and a run that ends well leaves none behind.
  void LookForDamage() {
    summary_.repaired = store_->Repaired();
    if (!store_->Grown().empty()) return;  // looked through before it grew
    const std::vector<store::DamagedMission> damage = store_->FindDamage();
    if (damage.empty()) return;
    if (!options_.repair) throw UserError(store::DamageText(options_.dir, damage.front()));
    CheckStageIsReady();
    for (const auto& [run, mission, name, what] : damage)
      if (!FliesAgain(layout_.Place(run, mission)))
        throw UserError(fmt::format(
            "{}: {} is damaged: {}; --repair takes out only what the same call flies again, and this "
            "one does not: 'ed3r run SWEEP --repair' without --stage, --shard and --only-failed does",
            options_.dir, name, what));
    store_->Remove(damage);
    summary_.repaired.insert(summary_.repaired.end(), damage.begin(), damage.end());
  }

  bool StandsOnItself() const {
    std::error_code none;  // a foundation that is not there is another one
    return options_.foundation.empty() ||
           std::filesystem::equivalent(options_.foundation, options_.dir, none);
  }

  const std::string& FoundationDir() const {
    return options_.foundation.empty() ? options_.dir : options_.foundation;
  }

  bool HasFoundation() const {
    return !options_.foundation.empty() &&
           std::filesystem::exists(std::filesystem::path(options_.foundation) / store::kResultsFile);
  }

  // The code of what is built upon and lies elsewhere: results of this run are made by it, too. A part that builds on nothing
  // is merged into the foundation later: it may be of a plan that the foundation's grows into then.
  store::CodeIdentities CheckedFoundation() const {
    if (StandsOnItself() || !HasFoundation()) return {};
    store::ResultReader reader(options_.foundation);
    const store::Recipe& there = reader.StoredRecipe();
    if (there.plan_text == recipe_.plan_text) {
      CheckSame(reader);
    } else {
      const store::Growth growth = store::GrowthOf(there, recipe_, store::StagesWithNetworks(reader));
      if (!growth.Allowed()) RefuseOther(growth.difference);
      store::CodeIdentities here = recipe_.code;
      std::erase_if(here, [&](const auto& entry) { return !there.code.contains(entry.first); });
      if (!options_.accept_mixed) RefuseOtherCode(options_.foundation, there.code, here);
    }
    const bool builds = std::any_of(plan_.stages.begin(), plan_.stages.end(), [&](const sweep::Stage& stage) {
      return stage.name == options_.stage && !stage.after.empty();
    });
    return builds ? there.code : store::CodeIdentities{};
  }

  void RefuseOther(const std::string& difference) const {
    throw UserError(fmt::format("{}: holds results of another recipe: {}; give another --from",
                                options_.foundation, difference));
  }

  void CheckSame(const store::ResultReader& reader) const {
    const store::Recipe& there = reader.StoredRecipe();
    if (const auto difference = store::Difference(there, recipe_)) RefuseOther(*difference);
    if (!options_.accept_mixed) RefuseOtherCode(options_.foundation, there.code, recipe_.code);
  }

  // What is stored where the stages before are.
  std::vector<sweep::RunId> Foundation() const {
    if (StandsOnItself()) return store_->Stored();
    if (!HasFoundation()) return {};
    store::ResultReader reader(options_.foundation);
    CheckSame(reader);
    return reader.Stored();
  }

  bool Ready(const sweep::Stage& stage) const {
    if (stage.after.empty()) return true;
    const std::vector<sweep::RunId> stored = Foundation();
    return std::all_of(stage.after.begin(), stage.after.end(), [&](const std::string& name) {
      return finished_.contains(name) ||
             ProgressOf(plan_, name, stored, FoundationDir(), options_.half_width).open.empty();
    });
  }

  void Fly(int stage) {
    FetchNetworks(stage);
    const bool precise = plan_.stages[static_cast<std::size_t>(stage)].precision.has_value();
    if (precise && options_.foundation.empty() && !options_.only_failed) return FlyUntilPrecise(stage);
    const std::vector<sweep::RunId> stored = store_->Stored();
    std::vector<sweep::RunId> todo = Todo(layout_, stage, options_.shard, stored);
    if (precise && !options_.only_failed) LeaveThisRound(stage, todo);
    FlyThese(stage, todo, stored);
  }

  void LeaveThisRound(int stage, std::vector<sweep::RunId>& todo) const {
    const StageProgress round = ProgressOf(plan_, plan_.stages[static_cast<std::size_t>(stage)].name,
                                           Foundation(), FoundationDir(), options_.half_width);
    std::erase_if(todo, [&](const sweep::RunId& id) { return !round.Asks(id); });
  }

  // Those that the training stage left in the store, where this session did not train.
  void FetchNetworks(int number) {
    const sweep::Stage& stage = plan_.stages[static_cast<std::size_t>(number)];
    std::vector<int> asking;
    for (int arm = 0; arm < static_cast<int>(stage.arms.size()); ++arm)
      if (NeedsTraining(stage.arms[static_cast<std::size_t>(arm)].config)) asking.push_back(arm);
    if (asking.empty() || networks_ != nullptr) return;
    const store::FlownNetworks flown =
        StandsOnItself() ? store_->Networks() : store::ResultReader(FoundationDir()).Networks();
    const bool all = std::all_of(asking.begin(), asking.end(), [&](int arm) {
      return std::any_of(flown.uses.begin(), flown.uses.end(),
                         [&](const store::NetworkUse& use) { return use.stage == number && use.arm == arm; });
    });
    if (!all)
      throw UserError(fmt::format(
          "{}: holds no networks, which stage {} asks; 'ed3r run SWEEP --stage NAME --out {}' with "
          "the name of the training stage puts them there",
          FoundationDir(), stage.name, FoundationDir()));
    networks_ = NetworkShelf::From(flown, FoundationDir());
    store_->PutNetworks(flown);
  }

  bool AnyAgainFrom(int stage) const {
    return std::any_of(again_.begin(), again_.end(),
                       [&](const sweep::RunId& id) { return id.stage >= stage; });
  }

  void FlyThese(int stage, std::vector<sweep::RunId> todo, const std::vector<sweep::RunId>& stored) {
    if (options_.only_failed)
      std::erase_if(todo, [&](const sweep::RunId& id) {
        return !std::binary_search(again_.begin(), again_.end(), id);
      });
    ScheduleOptions schedule = options_.schedule;
    schedule.label = plan_.stages[static_cast<std::size_t>(stage)].name;
    schedule.stored_before = StoredOfStage(stored, stage);
    const FlyFn fly = [&](const sweep::RunId& id, const std::atomic<bool>& stop) {
      mission::MissionTask task = TaskOf(plan_, inputs_, networks_.get(), id);
      task.stop = &stop;
      return mission::FlyMission(task);
    };
    std::vector<sweep::RunId> inside, outside;
    std::partition_copy(todo.begin(), todo.end(), std::back_inserter(outside), std::back_inserter(inside),
                        [&](const sweep::RunId& id) { return IsOutside(ArmOf(id)); });
    Add(RunMissions(inside, fly, *store_, schedule), summary_.flown);
    while (!outside.empty() && !summary_.flown.interrupted) {
      const int arm = outside.front().arm;
      std::vector<sweep::RunId> of_arm;
      std::copy_if(outside.begin(), outside.end(), std::back_inserter(of_arm),
                   [&](const sweep::RunId& id) { return id.arm == arm; });
      std::erase_if(outside, [&](const sweep::RunId& id) { return id.arm == arm; });
      Add(FlyOutside(of_arm, schedule), summary_.flown);
    }
  }

  const sweep::Arm& ArmOf(const sweep::RunId& id) const {
    return plan_.stages[static_cast<std::size_t>(id.stage)].arms[static_cast<std::size_t>(id.arm)];
  }

  RunSummary FlyOutside(const std::vector<sweep::RunId>& todo, const ScheduleOptions& schedule) {
    const auto missions = static_cast<std::int64_t>(todo.size());
    Recorder recorder(*store_, schedule, missions, todo.size());
    options_.outside(
        ArmOf(todo.front()), todo,
        [&](const sweep::RunId& id, std::optional<mission::MissionRecord> record, store::Failure failure) {
          recorder.Offer({id, std::move(record), std::move(failure), 0.0});
        },
        recorder.stop());
    RunSummary summary = recorder.Finish();
    summary.threads = ThreadsFor(schedule.threads);
    summary.dropped = missions - summary.stored - summary.failed;
    summary.interrupted = summary.dropped > 0;
    return summary;
  }

  // Rounds of `every` missions for the arms that are not yet known well enough. A run that goes on takes the same
  // decisions again from what is stored.
  void FlyUntilPrecise(int stage) {
    const sweep::Stage& plan = plan_.stages[static_cast<std::size_t>(stage)];
    const sweep::Precision& precision = *plan.precision;
    std::vector<int> open(plan.arms.size());
    std::iota(open.begin(), open.end(), 0);
    for (int upto = 0; upto < plan.missions && !open.empty();) {
      upto = std::min(upto + precision.every, plan.missions);
      const std::vector<sweep::RunId> stored = store_->Stored();
      std::vector<sweep::RunId> todo = Todo(layout_, stage, options_.shard, stored);
      std::erase_if(todo, [&](const sweep::RunId& id) {
        return id.mission >= upto || std::find(open.begin(), open.end(), id.arm) == open.end();
      });
      const std::int64_t failed_before = summary_.flown.failed;
      FlyThese(stage, todo, stored);
      store_->Commit();
      if (summary_.flown.interrupted || summary_.flown.failed > failed_before) return;
      std::erase_if(open, [&](int arm) {
        return options_.half_width(options_.dir, stage, plan.arms[static_cast<std::size_t>(arm)].name, upto,
                                   precision.metric) <= precision.half_width;
      });
    }
    finished_.insert(plan.name);
  }

  void Train(const std::string& stage) {
    store_->Commit();
    std::unique_ptr<NetworkShelf> trained = TrainNetworks(
        plan_, {stage, FoundationDir(), options_.cache_dir, ThreadsFor(options_.schedule.threads),
                options_.schedule.stop, options_.schedule.progress, options_.schedule.quiet});
    if (trained == nullptr) {
      summary_.flown.interrupted = true;
      return;
    }
    if (networks_ == nullptr) networks_ = std::make_unique<NetworkShelf>();
    networks_->Take(std::move(*trained));
    store_->PutNetworks(networks_->Flown());
    summary_.networks = networks_->All();
  }

  const sweep::SweepPlan& plan_;
  const Inputs& inputs_;
  const SweepOptions& options_;
  const store::RunLayout layout_;
  const store::Recipe recipe_;  // what this session itself flies by
  std::unique_ptr<store::ResultStore> store_;
  std::unique_ptr<NetworkShelf> networks_;
  std::vector<sweep::RunId> again_;  // missions that have failed, where only those are asked for
  std::set<std::string>
      finished_;  // stages with a precision whose arms are all known well enough, or flown out
  SweepSummary summary_;
};

}  // namespace

SweepSummary RunSweep(const sweep::SweepPlan& plan, const Inputs& inputs, const SweepOptions& options) {
  CheckStageName(plan, options.stage);
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      if (stage.kind == sweep::StageKind::kFly && IsOutside(arm) && !options.outside)
        throw UserError(
            fmt::format("{}: stage {}: arm {}: the decisions of strategy {} come from a program; fly it with "
                        "ed3r.fly of the "
                        "Python module",
                        plan.file, stage.name, arm.name, agents::kOutsideStrategy));
  for (const sweep::Stage& stage : plan.stages)
    if (stage.precision && options.shard.count > 1 && options.foundation.empty())
      throw UserError(
          fmt::format("{}: stage {}: a precision needs all missions of an arm; fly it without --shard, or in "
                      "rounds as 'ed3r slurm' does",
                      plan.file, stage.name));
  return SweepRun(plan, inputs, options).Run();
}

}  // namespace ed3r::schedule
