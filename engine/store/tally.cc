#include "engine/store/tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "engine/core/check.h"
#include "engine/store/file_system.h"
#include "engine/store/part_of_run.h"
#include "engine/store/records.h"
#include "engine/store/schema.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

std::string FileIn(const std::string& dir) { return (fs::path(dir) / kResultsFile).string(); }

// Seconds since the file or its write-ahead log was written.
double QuietFor_s(const std::string& dir) {
  auto written = fs::file_time_type::min();
  for (const char* suffix : {"", "-wal"}) {
    std::error_code error;
    const auto time = fs::last_write_time(ResultsFileOf(dir) + suffix, error);
    if (!error) written = std::max(written, time);
  }
  return std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
}

}  // namespace

Tally::Tally(const Recipe& recipe, const RunLayout& layout) : recipe_(recipe), layout_(layout) {
  for (const RunLayout::Stage& stage : layout.stages)
    for (std::size_t arm = 0; arm < stage.arms.size(); ++arm)
      done_.emplace_back(static_cast<std::size_t>(stage.missions));
  failed_ = done_;
}

void Tally::Add(const std::string& dir) {
  ResultReader reader(dir);
  const PartOfRun part = FindPlan(recipe_, layout_, reader);
  if (!part.Counts())
    throw UserError(fmt::format("{}: holds results of {}: {}", dir,
                                part.plan == PartPlan::kGrown
                                    ? "a plan that has grown, which 'ed3r merge' takes in"
                                    : "another recipe",
                                part.what));
  Connection database(FileIn(dir), Connection::Access::kReadOnly);
  const Transaction moment(database, Transaction::Kind::kRead);
  Mark(database, reader.Layout(), "missions", done_);
  Mark(database, reader.Layout(), "failures", failed_);
}

void Tally::Mark(Connection& database, const RunLayout& of, const char* table,
                 std::vector<std::vector<bool>>& marks) const {
  std::vector<std::int64_t> runs;  // here, by the store's numbers
  for (std::size_t s = 0; s < of.stages.size(); ++s)
    for (std::size_t a = 0; a < of.stages[s].arms.size(); ++a) {
      const auto here = SameMission(of, {static_cast<int>(s), static_cast<int>(a), 0}, layout_);
      runs.push_back(here ? layout_.RunIndex(here->stage, here->arm) : -1);
    }
  // The small index may be damaged, which nothing here would show.
  const bool missions = std::string_view(table) == "missions";
  Statement select(database,
                   fmt::format("SELECT run, mission FROM {} {}", table, missions ? kAlongTheKey : ""));
  while (select.Step()) {
    const std::int64_t run = select.Int(0), mission = select.Int(1);
    const std::int64_t here = run < 0 || run >= std::ssize(runs) ? -1 : runs[static_cast<std::size_t>(run)];
    if (here < 0 || !of.Place(run, mission))
      throw UserError(DamageText(
          database.file(), {run, mission, of.DescribeKeys(run, mission), "the plan has no such mission"}));
    marks[static_cast<std::size_t>(here)][static_cast<std::size_t>(mission)] = true;
  }
}

std::vector<ArmStatus> Tally::Arms() const {
  std::vector<ArmStatus> arms;
  for (const RunLayout::Stage& stage : layout_.stages)
    for (const RunLayout::Arm& arm : stage.arms) {
      const std::vector<bool>&done = done_[arms.size()], &failed = failed_[arms.size()];
      ArmStatus& status = arms.emplace_back();
      status.stage = stage.name;
      status.arm = arm.name;
      status.planned = stage.missions;
      status.done = std::count(done.begin(), done.end(), true);
      for (std::size_t i = 0; i < done.size(); ++i) status.failed += failed[i] && !done[i] ? 1 : 0;
      status.missing = status.planned - status.done - status.failed;
    }
  return arms;
}

double MissionsPerSecond(const std::string& dir, double still_s) {
  if (QuietFor_s(dir) > still_s) return 0.0;
  Connection database(FileIn(dir), Connection::Access::kReadOnly);
  Statement last(database,
                 "SELECT (SELECT count(*) FROM timings WHERE timings.session = sessions.session), "
                 "unixepoch('now') - unixepoch(begun_utc) FROM sessions WHERE ended_utc IS NULL "
                 "ORDER BY begun_utc DESC LIMIT 1");
  if (!last.Step() || last.Int(1) <= 0) return 0.0;
  return static_cast<double>(last.Int(0)) / static_cast<double>(last.Int(1));
}

}  // namespace ed3r::store
