#include "engine/app/stage_state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "engine/app/commands.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/schedule/progress_of_stage.h"
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

// Of the missions that the stores hold together, in plan order.
struct Together {
  std::vector<sweep::RunId> stored, failed;
};

Together ReadTogether(const store::ResultReader& first, const std::vector<std::string>& stores) {
  std::set<sweep::RunId> stored, failed;
  for (const std::string& dir : stores) {
    store::ResultReader reader(dir);
    if (const auto difference = store::Difference(first.StoredRecipe(), reader.StoredRecipe()))
      throw UserError(
          fmt::format("{}: holds results of another recipe than {}: {}", dir, first.dir(), *difference));
    const std::vector<sweep::RunId> here = reader.Stored();
    stored.insert(here.begin(), here.end());
    for (const store::FailedMission& failure : reader.Failures()) failed.insert(failure.id);
  }
  std::erase_if(failed, [&](const sweep::RunId& id) { return stored.contains(id); });
  return {{stored.begin(), stored.end()}, {failed.begin(), failed.end()}};
}

// With a precision there is one store: intervals are over all that is stored.
int Tell(const sweep::SweepPlan& plan, const sweep::Stage& stage, const store::ResultReader& first,
         const std::vector<std::string>& stores) {
  const Together together = ReadTogether(first, stores);
  const schedule::StageProgress progress =
      schedule::ProgressOf(plan, stage.name, together.stored, stores.front(), report::HalfWidth);
  if (progress.open.empty()) {
    fmt::print("stage {}: finished\n", stage.name);
    return kDone;
  }
  const auto failed =
      std::count_if(together.failed.begin(), together.failed.end(), [&](const sweep::RunId& id) {
        return plan.stages[static_cast<std::size_t>(id.stage)].name == stage.name && progress.Asks(id);
      });
  fmt::print("stage {}: {} missing, {} failed, up to mission {} of {}\n", stage.name,
             Counted(progress.missing - failed, "mission"), failed, progress.upto,
             Counted(static_cast<std::int64_t>(progress.open.size()), "arm"));
  return stage.precision && failed == 0 ? kRequeue : kMissionsFailed;
}

}  // namespace

int TellStage(const std::string& dir, const std::string& name) {
  store::AddingStores found = store::StoresThatAdd(dir);
  TellNotes(found.notes);
  const std::vector<std::string> stores = found.dirs.empty() ? std::vector{dir} : std::move(found.dirs);
  const store::ResultReader first(stores.front());
  const sweep::SweepPlan plan =
      sweep::PlanOf(sweep::ReadPlanText(first.StoredRecipe().plan_text), stores.front());
  const sweep::Stage& stage = FindStage(plan, dir, name);
  if (!stage.precision || stores.size() == 1) return Tell(plan, stage, first, stores);
  const store::GatheredShards gathered(dir);
  return Tell(plan, stage, first, {gathered.dir()});
}

}  // namespace ed3r::app
