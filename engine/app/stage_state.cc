#include "engine/app/stage_state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "engine/app/commands.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/schedule/progress_of_stage.h"
#include "engine/schedule/training_stage.h"
#include "engine/store/reader.h"
#include "engine/store/shards/gathered_shards.h"
#include "engine/sweep/plan_text.h"
#include "studies/report/load.h"

namespace ed3r::app {
namespace {

const sweep::Stage& FindStage(const sweep::SweepPlan& plan, const std::string& dir, const std::string& name) {
  std::vector<std::string> names;
  for (const sweep::Stage& stage : plan.stages) {
    if (stage.name == name) return stage;
    names.push_back(stage.name);
  }
  throw UserError(fmt::format("{}: no stage '{}'; allowed: {}{}", dir, name, fmt::join(names, ", "),
                              DidYouMean(name, names)));
}

// Networks that lie in the cache alone are not counted: what flies next takes them from the run.
int TellTraining(const sweep::SweepPlan& plan, const std::string& stage, store::ResultReader& run) {
  const std::int64_t untrained = schedule::CountUntrained(plan, stage, run.Networks().uses);
  if (untrained == 0)
    fmt::print("stage {}: finished\n", stage);
  else
    fmt::print("stage {}: not trained, networks of {} are missing\n", stage, Counted(untrained, "arm"));
  return untrained == 0 ? kDone : kMissionsFailed;
}

// The first; none where looking would take long.
std::optional<store::DamagedMission> DamageOf(store::ResultReader& run, const std::string& stage) {
  if (!run.Tables().checked() || !run.IsQuicklyCompared()) return std::nullopt;
  for (store::DamagedMission& damage : run.FindDamage())
    if (const auto id = run.Layout().Place(damage.run, damage.mission);
        !id || run.Layout().stages[static_cast<std::size_t>(id->stage)].name == stage)
      return std::move(damage);
  return std::nullopt;
}

int TellFlights(const sweep::SweepPlan& plan, const sweep::Stage& stage, store::ResultReader& run) {
  const schedule::StageProgress progress =
      schedule::ProgressOf(plan, stage.name, run.Stored(), run.dir(), report::HalfWidth);
  if (progress.open.empty()) {
    const std::optional<store::DamagedMission> damage = DamageOf(run, stage.name);
    if (!damage) fmt::print("stage {}: finished\n", stage.name);
    if (damage)
      fmt::print("stage {}: damaged: {}: {}; 'ed3r verify' names all\n", stage.name, damage->name,
                 damage->what);
    return damage ? kFailedInside : kDone;
  }
  const std::vector<store::FailedMission> failures = run.Failures();
  const auto failed =
      std::count_if(failures.begin(), failures.end(), [&](const store::FailedMission& failure) {
        return plan.stages[static_cast<std::size_t>(failure.id.stage)].name == stage.name &&
               progress.Asks(failure.id);
      });
  fmt::print("stage {}: {} missing, {} failed, up to mission {} of {}\n", stage.name,
             Counted(progress.missing - failed, "mission"), failed, progress.upto,
             Counted(static_cast<std::int64_t>(progress.open.size()), "arm"));
  return stage.precision && failed == 0 ? kRequeue : kMissionsFailed;
}

}  // namespace

int TellStage(const std::string& dir, const std::string& name) {
  const store::GatheredShards gathered(dir);
  TellNotes(gathered.notes());
  store::ResultReader run(gathered.dir());
  const sweep::SweepPlan plan = sweep::PlanOf(sweep::ReadPlanText(run.StoredRecipe().plan_text), dir);
  const sweep::Stage& stage = FindStage(plan, dir, name);
  return stage.kind == sweep::StageKind::kTrain ? TellTraining(plan, stage.name, run)
                                                : TellFlights(plan, stage, run);
}

}  // namespace ed3r::app
