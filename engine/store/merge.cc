#include "engine/store/merge.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "engine/core/check.h"
#include "engine/store/damage.h"
#include "engine/store/digest.h"
#include "engine/store/reader.h"
#include "engine/store/records.h"
#include "engine/store/store_file.h"

namespace ed3r {
namespace {

// A result file that others are merged into; the transaction is the caller's.
class Target {
 public:
  // `layout` must outlive it.
  Target(Connection& database, const RunLayout& layout, std::string dir)
      : database_(database),
        layout_(layout),
        dir_(std::move(dir)),
        writer_(database, layout),
        cursor_(database, layout, MissionCursor::kOneMission, Steps::kLoad),
        // Merged while it ran and again after its end: the end is the news.
        put_session_(database,
                     "INSERT INTO sessions VALUES (?, ?, ?, ?, nullif(?, '')) ON CONFLICT DO UPDATE "
                     "SET ended_utc = coalesce(excluded.ended_utc, ended_utc)"),
        put_note_(database, "INSERT OR REPLACE INTO session_notes VALUES (?, ?, ?)"),
        has_mission_(database, "SELECT 1 FROM missions WHERE run = ? AND mission = ?") {}

  void Add(ResultReader& source) {
    AddSessions(source);
    PutNetworks(database_, layout_, source.Networks());
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
    if (cursor_.Seek(run, mission.id.mission)) {
      cursor_.Checked();
      if (CanonicalBytes(cursor_.record()) != CanonicalBytes(mission.record))
        throw UserError(fmt::format("{}: {} differs from the record of another store that is merged into {}",
                                    source.dir(), source.Layout().Describe(mission.id), dir_));
      ++summary_.present;
      return;
    }
    writer_.InsertMission(mission.id, mission.record);
    writer_.InsertTiming(mission.id, mission.session, mission.wall_s);
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
        writer_.InsertFailure(failure.id, failure.scenario, failure.seed, {failure.kind, failure.message});
    }
  }

  Connection& database_;
  const RunLayout& layout_;
  std::string dir_;
  RecordWriter writer_;
  MissionCursor cursor_;
  Statement put_session_, put_note_, has_mission_;
  MergeSummary summary_;
};

void CheckSameRecipe(const ResultReader& first, const ResultReader& other) {
  if (const auto difference = Difference(first.StoredRecipe(), other.StoredRecipe()))
    throw UserError(
        fmt::format("{} (there) and {} (here) cannot be merged: {}", first.dir(), other.dir(), *difference));
  for (const auto& [there, here] : {std::pair(&first, &other), std::pair(&other, &first)})
    if (const auto code = CodeDifference(there->StoredRecipe().code, here->StoredRecipe().code))
      throw UserError(
          fmt::format("{} (there) and {} (here) cannot be merged: {}", there->dir(), here->dir(), *code));
  if (!first.Layout().SameMissions(other.Layout()))
    throw UserError(fmt::format("{} and {} cannot be merged: their stages, arms or seeds differ", first.dir(),
                                other.dir()));
}

// What is in `out` already and in no source would come through unseen.
void CheckWhole(Connection& database, const RunLayout& layout) {
  const std::vector<DamagedMission> damage = FindDamage(database, layout);
  if (!damage.empty()) throw UserError(DamageText(database.file(), damage.front()));
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
  Recipe recipe = sources.front()->StoredRecipe();
  recipe.files = sources.front()->Files();
  const RunLayout layout = sources.front()->Layout();
  // What is in `out` need not be copied; and a reader on it would keep its file in WAL mode.
  std::erase_if(sources, [&](const auto& source) { return SameDirectory(source->dir(), out); });
  StoreFile file(out, recipe, layout);
  try {
    Transaction transaction(file.database(), Transaction::Kind::kWrite);
    CheckWhole(file.database(), layout);
    Target target(file.database(), layout, out);
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
