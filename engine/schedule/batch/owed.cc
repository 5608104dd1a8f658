#include "engine/schedule/batch/owed.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "engine/core/check.h"
#include "engine/schedule/todo.h"
#include "engine/schedule/training_stage.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/shards/shards.h"

namespace ed3r::schedule {
namespace {

namespace fs = std::filesystem;

class Books {
 public:
  Books(const sweep::SweepPlan& plan, const std::string& run_dir, const std::string& cache_dir,
        const HalfWidthFn& half_width)
      : plan_(plan),
        layout_(store::LayoutOf(plan)),
        run_dir_(run_dir),
        cache_dir_(cache_dir),
        half_width_(half_width) {
    if (!store::HoldsResults(run_dir)) return;
    store::ResultReader reader(run_dir);
    CheckPlan(reader);
    merged_ = reader.Stored();
    networks_ = reader.Networks().uses;
  }

  // The flights of a stage: their tasks, or the merge where all is flown. False when it is finished.
  bool Flights(const BatchStep& step, int number, Owed& owed) const {
    const StageProgress progress = ProgressOf(plan_, step.stage, merged_, run_dir_, half_width_);
    if (progress.open.empty()) return false;
    const std::vector<sweep::RunId> stored = WithShards(step.stage);
    std::set<std::int64_t> tasks;
    const Shard every{};
    for (const sweep::RunId& id : Todo(layout_, StageNumber(step.stage), every, stored)) {
      if (!progress.Asks(id)) continue;
      tasks.insert(TaskOf(ShardOf(layout_.LinearIndex(id), step.tasks), step.tasks));
      ++owed.missions;
    }
    owed.tasks.assign(tasks.begin(), tasks.end());
    owed.step = tasks.empty() ? number + 1 : number;
    return true;
  }

  bool Trainings(const BatchStep& step, int number, Owed& owed) const {
    if (CountUntrained(plan_, step.stage, networks_) == 0) return false;
    TrainingOptions options;
    options.stage = step.stage, options.run_dir = run_dir_, options.cache_dir = cache_dir_;
    const std::vector<bool> cached = NetworksInCache(plan_, options);
    for (std::size_t i = 0; i < cached.size(); ++i)
      if (!cached[i]) owed.tasks.push_back(TaskOf(static_cast<std::int64_t>(i), step.tasks));
    std::sort(owed.tasks.begin(), owed.tasks.end());
    owed.step = owed.tasks.empty() ? number + 1 : number;
    return true;
  }

  bool Report(int number, Owed& owed) const {
    std::error_code error;
    const auto made = fs::last_write_time(fs::path(run_dir_) / "report" / "index.html", error);
    if (!error && made >= fs::last_write_time(fs::path(run_dir_) / store::kResultsFile)) return false;
    owed.step = number;
    return true;
  }

 private:
  // Tasks are counted from 1: the last one flies shard 0.
  static std::int64_t TaskOf(std::int64_t shard, std::int64_t tasks) { return shard == 0 ? tasks : shard; }

  // The numbers of arms and missions are those of a plan. A plan that has only grown is flown on by its first tasks.
  void CheckPlan(const store::ResultReader& reader) const {
    if (reader.StoredRecipe().plan_text != plan_.CanonicalText())
      throw UserError(fmt::format(
          "{}: holds results of another plan, and what is owed cannot be counted against this one; "
          "give the options (--set, --missions, --seed) that it was made with, or another --out; where the "
          "sweep has only grown "
          "since, submit it as a whole (without --missing): every task flies what it lacks",
          reader.dir()));
  }

  int StageNumber(const std::string& name) const {
    const auto found = std::find_if(plan_.stages.begin(), plan_.stages.end(),
                                    [&](const sweep::Stage& stage) { return stage.name == name; });
    return static_cast<int>(found - plan_.stages.begin());
  }

  std::vector<sweep::RunId> WithShards(const std::string& stage) const {
    std::vector<sweep::RunId> stored = merged_;
    for (const std::string& dir : store::ShardDirs(run_dir_, stage)) {
      store::ResultReader reader(dir);
      CheckPlan(reader);
      const std::vector<sweep::RunId> of_task = reader.Stored();
      stored.insert(stored.end(), of_task.begin(), of_task.end());
    }
    std::sort(stored.begin(), stored.end());
    return stored;
  }

  const sweep::SweepPlan& plan_;
  const store::RunLayout layout_;
  const std::string &run_dir_, &cache_dir_;
  const HalfWidthFn& half_width_;
  std::vector<sweep::RunId> merged_;
  std::vector<store::NetworkUse> networks_;
};

}  // namespace

Owed WhatIsOwed(const sweep::SweepPlan& plan, const std::vector<BatchStep>& steps, const std::string& run_dir,
                const std::string& cache_dir, const HalfWidthFn& half_width) {
  const Books books(plan, run_dir, cache_dir, half_width);
  Owed owed;
  for (std::size_t i = 0; i < steps.size() && owed.step == 0; ++i) {
    const int number = static_cast<int>(i) + 1;
    const BatchStep& step = steps[i];
    if (step.kind == BatchStep::Kind::kFly) books.Flights(step, number, owed);
    if (step.kind == BatchStep::Kind::kTrain) books.Trainings(step, number, owed);
    if (step.kind == BatchStep::Kind::kReport) books.Report(number, owed);
  }
  return owed;
}

}  // namespace ed3r::schedule
