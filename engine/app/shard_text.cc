#include "engine/app/shard_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "engine/app/words.h"
#include "engine/schedule/batch/shell.h"
#include "engine/store/layout.h"
#include "engine/store/reader.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

struct Row {
  std::string stage, arm;
  std::int64_t missions = 0, done = 0, failed = 0;
  std::int64_t Missing() const { return missions - done - failed; }
};

std::vector<Row> Rows(const sweep::SweepPlan& plan, const schedule::Shard& shard, const std::string& name,
                      const std::string& dir) {
  store::ResultReader reader(dir);
  const std::vector<sweep::RunId> stored = reader.Stored();
  std::vector<sweep::RunId> failed;
  for (const store::FailedMission& failure : reader.Failures()) failed.push_back(failure.id);
  const store::RunLayout layout = store::LayoutOf(plan);
  std::vector<Row> rows;
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    const sweep::Stage& stage = plan.stages[s];
    if (stage.kind != sweep::StageKind::kFly || (!name.empty() && stage.name != name)) continue;
    const std::size_t first = rows.size();
    for (const sweep::Arm& arm : stage.arms) rows.push_back({stage.name, arm.name});
    for (const sweep::RunId& id : schedule::Todo(layout, static_cast<int>(s), shard, {})) {
      Row& row = rows[first + static_cast<std::size_t>(id.arm)];
      ++row.missions;
      if (std::binary_search(stored.begin(), stored.end(), id))
        ++row.done;
      else if (std::binary_search(failed.begin(), failed.end(), id))
        ++row.failed;
    }
  }
  return rows;
}

// RUN of RUN/shards/STAGE/TASK, where batch tasks leave their stores; "" of any other directory.
std::string RunOfTask(const std::string& dir) {
  fs::path path = fs::path(dir).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const fs::path shards = path.parent_path().parent_path();
  return shards.filename() == "shards" && shards.has_parent_path() ? shards.parent_path().string() : "";
}

std::string MergeCommand(const std::string& dir) {
  const std::string run = RunOfTask(dir);
  if (run.empty()) return fmt::format("ed3r merge OUT {} DIR...", schedule::ShellWord(dir));
  const fs::path stage = fs::path(dir).lexically_normal();
  const fs::path tasks = stage.has_filename() ? stage.parent_path() : stage.parent_path().parent_path();
  return fmt::format("ed3r merge {} {}/*/", schedule::ShellWord(run), schedule::ShellWord(tasks.string()));
}

bool GoesInRounds(const sweep::SweepPlan& plan, const std::string& name) {
  return std::any_of(plan.stages.begin(), plan.stages.end(), [&](const sweep::Stage& stage) {
    return stage.precision && (name.empty() || stage.name == name);
  });
}

}  // namespace

std::string ShardTable(const sweep::SweepPlan& plan, const schedule::Shard& shard, const std::string& stage,
                       const std::string& dir) {
  std::string text = fmt::format("part {} of {}\n{:<12} {:<28} {:>8} {:>8} {:>8} {:>8}\n",
                                 shard.index == 0 ? shard.count : shard.index, shard.count, "stage", "arm",
                                 "its part", "done", "failed", "missing");
  for (const Row& row : Rows(plan, shard, stage, dir))
    text += fmt::format("{:<12} {:<28} {:>8} {:>8} {:>8} {:>8}\n", row.stage, row.arm, row.missions, row.done,
                        row.failed, row.Missing());
  return text;
}

std::string AfterShard(const sweep::SweepPlan& plan, const schedule::Shard& shard, const std::string& stage,
                       const std::string& dir, const std::string& waiting_stage) {
  const std::vector<Row> rows = Rows(plan, shard, stage, dir);
  const bool failed = std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.failed > 0; });
  std::string text;
  if (failed)
    text +=
        fmt::format("next: 'ed3r status {}' tells why missions failed; the same command flies them again\n",
                    schedule::ShellWord(dir));
  else
    text += fmt::format("next, when all {} are flown: {}\n", Counted(shard.count, "part"), MergeCommand(dir));
  if (!waiting_stage.empty())
    text += fmt::format(
        "stage {} builds on all parts: 'ed3r run SWEEP --stage {} --out OUT' where they are merged\n",
        waiting_stage, waiting_stage);
  if (GoesInRounds(plan, stage) && !failed)
    text +=
        "it goes in rounds: where they are merged, 'ed3r status OUT --stage NAME' tells whether another is "
        "due\n";
  return text;
}

}  // namespace ed3r::app
