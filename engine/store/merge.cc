#include "engine/store/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>

#include "engine/core/check.h"
#include "engine/store/damage.h"
#include "engine/store/digest.h"
#include "engine/store/joined_missions.h"
#include "engine/store/reader.h"
#include "engine/store/records.h"
#include "engine/store/schema.h"
#include "engine/store/store_file.h"

namespace ed3r::store {
namespace {

// Stores that are read side by side: each keeps files open and some hundred kilobytes. Read so, their missions come in plan
// order, however they were divided, and the target's tables grow at their ends.
constexpr std::size_t kReadAtOnce = 128;
// Reading and comparing a mission takes about twice as long as putting it.
constexpr int kMostReadingThreads = 4;

int ReadingThreads() {
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMostReadingThreads);
}

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
        has_mission_(database, "SELECT 1 FROM missions WHERE run = ? AND mission = ?"),
        holds_missions_(database.Int("SELECT count(*) FROM (SELECT 1 FROM missions LIMIT 1)") > 0) {}

  void Add(const std::vector<std::unique_ptr<ResultReader>>& sources) {
    std::vector<bool> same_columns;
    for (const auto& source : sources) {
      AddSessions(*source);
      PutNetworks(database_, layout_, source->Networks());
      same_columns.push_back(HasColumnsOf(source->Tables()));
    }
    JoinedMissions missions(sources, ReadingThreads());
    while (const ComparedMission* mission = missions.Next())
      AddMission(sources[missions.source()]->dir(), same_columns[missions.source()], *mission);
    for (const auto& source : sources) AddFailures(*source);
    holds_missions_ = true;
  }

  const MergeSummary& summary() const { return summary_; }

 private:
  // Where both files' checksums are over the same, one is known by the other.
  bool HasColumnsOf(const RecordTables& tables) const {
    return tables.missions().names() == writer_.Tables().missions().names() &&
           tables.timesteps().names() == writer_.Tables().timesteps().names();
  }

  void AddSessions(ResultReader& source) {
    for (const Session& session : source.Sessions()) {
      put_session_.Run(session.id, session.host, session.process, session.begun_utc, session.ended_utc);
      for (const auto& [key, value] : session.notes) put_note_.Run(session.id, key, value);
    }
  }

  void AddMission(const std::string& from, bool same_columns, const ComparedMission& mission) {
    const std::pair key{mission.run, mission.mission};
    // In plan order, what an empty file holds of a mission is what was put just now.
    const bool may_be_there = holds_missions_ || key == last_;
    last_ = key;
    if (may_be_there && cursor_.Seek(mission.run, mission.mission)) {
      if (!IsSame(same_columns, mission))
        throw UserError(fmt::format("{}: {} differs from the record of another store that is merged into {}",
                                    from, layout_.Describe(mission.id), dir_));
      ++summary_.present;
      return;
    }
    if (same_columns)
      writer_.InsertMission(mission.id, mission.record, mission.checksums);
    else if (mission.keeps_timesteps)
      writer_.InsertMission(mission.id, mission.record);
    else
      writer_.InsertWithoutTimesteps(mission.id, mission.record, mission.checksums.steps);
    if (!std::isnan(mission.wall_s)) writer_.InsertTiming(mission.id, mission.session, mission.wall_s);
    ++summary_.added;
  }

  // As the mission that the cursor is at. Both have been compared with their checksums.
  bool IsSame(bool same_columns, const ComparedMission& mission) {
    cursor_.Checked();
    if (same_columns) return mission.checksums == Checksums{cursor_.checksum(), cursor_.steps_checksum()};
    return CanonicalBytes(cursor_.record()) == CanonicalBytes(mission.record) &&
           (mission.keeps_timesteps || cursor_.steps_checksum() == mission.checksums.steps);
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
  bool holds_missions_;  // from before, or from other stores than those that are read now
  std::pair<std::int64_t, std::int64_t> last_{-1, -1};  // the mission that was added last
  MergeSummary summary_;
};

void CheckSameRecipe(const ResultReader& first, const ResultReader& other) {
  // What is merged is given checksums, as if it had been compared with some.
  if (!other.Tables().checked())
    throw UserError(fmt::format("{}: {}: it can be read, but not merged; fly it again into another --out",
                                other.dir(), kNothingToCompare));
  const std::vector<RunLayout::Stage>& stages = other.Layout().stages;
  for (std::size_t s = 0; s < stages.size(); ++s)
    if (!other.Tables().complete() &&
        other.Tables().KeptOf(static_cast<int>(s)) != sweep::KeptTimesteps::kAll)
      throw UserError(
          fmt::format("{}: written by an older ed3r without the timesteps of stage {}, of which their new "
                      "checksums would be made: it can be read, but not merged",
                      other.dir(), stages[s].name));
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

// Of the first, when those of all others are equal.
std::pair<Recipe, RunLayout> CommonRecipe(const std::vector<std::string>& dirs) {
  ResultReader first(dirs.front());
  for (const std::string& dir : dirs) CheckSameRecipe(first, ResultReader(dir));
  Recipe recipe = first.StoredRecipe();
  recipe.files = first.Files();
  return {std::move(recipe), first.Layout()};
}

// What is in `out` already and in no source would come through unseen.
void CheckWhole(Connection& database, const RunLayout& layout) {
  const std::vector<DamagedMission> damage = FindDamage(database, layout);
  if (!damage.empty()) throw UserError(DamageText(database.file(), damage.front()));
}

// Also where the file is linked: it is one.
bool SameStore(const std::string& a, const std::string& b) {
  const std::filesystem::path one = std::filesystem::path(a) / kResultsFile,
                              other = std::filesystem::path(b) / kResultsFile;
  return std::filesystem::exists(one) && std::filesystem::exists(other) &&
         std::filesystem::equivalent(one, other);
}

}  // namespace

MergeSummary MergeStores(const std::string& out, const std::vector<std::string>& dirs) {
  if (dirs.empty()) throw UserError(fmt::format("{}: nothing to merge into it", out));
  const auto [recipe, layout] = CommonRecipe(dirs);
  // What is in `out` need not be copied; and a reader on it would keep its file in WAL mode.
  std::vector<std::string> others = dirs;
  std::erase_if(others, [&](const std::string& dir) { return SameStore(dir, out); });
  StoreFile file(out, recipe, layout);
  try {
    Transaction transaction(file.database(), Transaction::Kind::kWrite);
    file.TakeUp(recipe, layout);
    if (file.grown().empty()) CheckWhole(file.database(), layout);  // else looked through before it grows
    Target target(file.database(), layout, out);
    for (std::size_t begin = 0; begin < others.size(); begin += kReadAtOnce) {
      std::vector<std::unique_ptr<ResultReader>> sources;
      for (std::size_t i = begin; i < std::min(begin + kReadAtOnce, others.size()); ++i)
        sources.push_back(std::make_unique<ResultReader>(others[i]));
      target.Add(sources);
    }
    MergeSummary summary = target.summary();
    summary.failed = file.database().Int("SELECT count(*) FROM failures");
    transaction.Commit();
    return summary;
  } catch (...) {
    file.Discard();
    throw;
  }
}

}  // namespace ed3r::store
