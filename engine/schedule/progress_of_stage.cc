#include "engine/schedule/progress_of_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "engine/core/check.h"

namespace ed3r::schedule {
namespace {

int StageNumber(const sweep::SweepPlan& plan, const std::string& name) {
  for (std::size_t i = 0; i < plan.stages.size(); ++i)
    if (plan.stages[i].name == name) return static_cast<int>(i);
  throw InternalError("a stage waits for '" + name + "', which the plan does not have");
}

// Stored missions of an arm below `upto`.
std::int64_t StoredBelow(const std::vector<sweep::RunId>& stored, int stage, int arm, int upto) {
  return std::lower_bound(stored.begin(), stored.end(), sweep::RunId{stage, arm, upto}) -
         std::lower_bound(stored.begin(), stored.end(), sweep::RunId{stage, arm, 0});
}

}  // namespace

bool StageProgress::Asks(const sweep::RunId& id) const {
  return id.mission < upto && std::binary_search(open.begin(), open.end(), id.arm);
}

StageProgress ProgressOf(const sweep::SweepPlan& plan, const std::string& name,
                         const std::vector<sweep::RunId>& stored, const std::string& dir,
                         const HalfWidthFn& half_width) {
  const int number = StageNumber(plan, name);
  const sweep::Stage& stage = plan.stages[static_cast<std::size_t>(number)];
  StageProgress progress;
  if (stage.kind == sweep::StageKind::kTrain) return progress;
  progress.open.resize(stage.arms.size());
  std::iota(progress.open.begin(), progress.open.end(), 0);
  while (!progress.open.empty() && progress.upto < stage.missions) {
    progress.upto =
        stage.precision ? std::min(progress.upto + stage.precision->every, stage.missions) : stage.missions;
    for (const int arm : progress.open)
      progress.missing += progress.upto - StoredBelow(stored, number, arm, progress.upto);
    if (progress.missing > 0) break;
    std::erase_if(progress.open, [&](int arm) {
      return !stage.precision || progress.upto == stage.missions ||
             half_width(dir, number, stage.arms[static_cast<std::size_t>(arm)].name, progress.upto,
                        stage.precision->metric) <= stage.precision->half_width;
    });
  }
  return progress;
}

void CheckReady(const sweep::SweepPlan& plan, const sweep::Stage& stage,
                const std::vector<sweep::RunId>& stored, const std::string& dir,
                const HalfWidthFn& half_width) {
  for (const std::string& name : stage.after) {
    const StageProgress progress = ProgressOf(plan, name, stored, dir, half_width);
    if (!progress.open.empty())
      throw UserError(fmt::format(
          "{}: stage {} builds on stage {}, of which {} missions are missing or failed; fly them first", dir,
          stage.name, name, progress.missing));
  }
}

}  // namespace ed3r::schedule
