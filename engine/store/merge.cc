#include "engine/store/merge.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "engine/core/check.h"
#include "engine/store/digest.h"
#include "engine/store/reader.h"
#include "engine/store/records.h"
#include "engine/store/store_file.h"

namespace ed3r {
namespace {

// A result file that others are merged into; the transaction is the caller's.
class Target {
 public:
  Target(Connection& database, std::string dir)
      : dir_(std::move(dir)),
        writer_(database),
        reader_(database),
        // Merged while it ran and again after its end: the end is the news.
        put_session_(database,
                     "INSERT INTO sessions VALUES (?, ?, ?, ?, nullif(?, '')) ON CONFLICT DO UPDATE "
                     "SET ended_utc = coalesce(excluded.ended_utc, ended_utc)"),
        put_note_(database, "INSERT OR REPLACE INTO session_notes VALUES (?, ?, ?)"),
        has_mission_(database, "SELECT 1 FROM missions WHERE run = ? AND mission = ?") {}

  void Add(ResultReader& source) {
    AddSessions(source);
    source.ForEachMission(Steps::kLoad, [&](const StoredMission& mission) { AddMission(source, mission); });
    AddFailures(source);
  }

  const MergeSummary& summary() const { return summary_; }

 private:
  void AddSessions(ResultReader& source) {
    for (const Session& session : source.Sessions()) {
      put_session_.Run(session.id, session.host, session.process, session.begun_utc, session.ended_utc);
      for (const auto& [key, value] : session.notes) put_note_.Run(session.id, key, value);
    }
  }

  void AddMission(const ResultReader& source, const StoredMission& mission) {
    const std::int64_t run = source.Layout().RunIndex(mission.id);
    MissionRecord present;
    if (reader_.ReadMission(run, mission.id.mission, present)) {
      if (CanonicalBytes(present) != CanonicalBytes(mission.record))
        throw UserError(fmt::format("{}: {} differs from the record of another store that is merged into {}",
                                    source.dir(), source.Layout().Describe(mission.id), dir_));
      ++summary_.present;
      return;
    }
    writer_.InsertMission(run, mission.id.mission, mission.record);
    writer_.InsertTiming(run, mission.id.mission, mission.session, mission.wall_s);
    ++summary_.added;
  }

  void AddFailures(ResultReader& source) {
    for (const FailedMission& failure : source.Failures()) {
      const std::int64_t run = source.Layout().RunIndex(failure.id);
      has_mission_.Bind(0, run);
      has_mission_.Bind(1, std::int64_t{failure.id.mission});
      const bool flown = has_mission_.Step();
      has_mission_.Reset();
      if (!flown)
        writer_.InsertFailure(run, failure.id.mission, failure.scenario, failure.seed, failure.message);
    }
  }

  std::string dir_;
  RecordWriter writer_;
  RecordReader reader_;
  Statement put_session_, put_note_, has_mission_;
  MergeSummary summary_;
};

void CheckSameRecipe(const ResultReader& first, const ResultReader& other) {
  if (const auto difference = Difference(first.StoredRecipe(), other.StoredRecipe()))
    throw UserError(
        fmt::format("{} (there) and {} (here) cannot be merged: {}", first.dir(), other.dir(), *difference));
  if (!first.Layout().SameMissions(other.Layout()))
    throw UserError(fmt::format("{} and {} cannot be merged: their stages, arms or seeds differ", first.dir(),
                                other.dir()));
}

bool SameDirectory(const std::string& a, const std::string& b) {
  return std::filesystem::exists(a) && std::filesystem::exists(b) && std::filesystem::equivalent(a, b);
}

}  // namespace

MergeSummary MergeStores(const std::string& out, const std::vector<std::string>& dirs) {
  if (dirs.empty()) throw UserError(fmt::format("{}: nothing to merge into it", out));
  std::vector<std::unique_ptr<ResultReader>> sources;
  for (const std::string& dir : dirs) {
    sources.push_back(std::make_unique<ResultReader>(dir));
    CheckSameRecipe(*sources.front(), *sources.back());
  }
  const Recipe recipe = sources.front()->StoredRecipe();
  const RunLayout layout = sources.front()->Layout();
  // What is in `out` need not be copied; and a reader on it would keep its file in WAL mode.
  std::erase_if(sources, [&](const auto& source) { return SameDirectory(source->dir(), out); });
  StoreFile file(out, recipe, layout);
  try {
    Transaction transaction(file.database(), Transaction::Kind::kWrite);
    Target target(file.database(), out);
    for (const auto& source : sources) target.Add(*source);
    MergeSummary summary = target.summary();
    summary.failed = file.database().Int("SELECT count(*) FROM failures");
    transaction.Commit();
    return summary;
  } catch (...) {
    file.Discard();
    throw;
  }
}

}  // namespace ed3r
