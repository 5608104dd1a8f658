#include "engine/store/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "engine/core/check.h"
#include "engine/store/damage.h"
#include "engine/store/digest.h"
#include "engine/store/reader.h"
#include "engine/store/records.h"
#include "engine/store/schema.h"
#include "engine/store/store_file.h"

namespace ed3r::store {
namespace {

// Sources that are read side by side: each keeps a file open and a few megabytes. Read so, their missions come in plan order,
// however they were divided, and the target's tables grow at their ends.
constexpr std::size_t kReadAtOnce = 128;

// The missions of one store in plan order, as of one moment.
class Source {
 public:
  explicit Source(const std::string& dir)
      : reader_(dir),
        database_((std::filesystem::path(dir) / kResultsFile).string(), Connection::Access::kReadOnly),
        moment_(database_, Transaction::Kind::kRead),
        cursor_(database_, reader_.Layout(), "", Steps::kLoad),
        more_(cursor_.Next()) {}

  ResultReader& reader() { return reader_; }
  bool more() const { return more_; }
  const MissionCursor& cursor() const { return cursor_; }
  std::pair<std::int64_t, std::int64_t> Key() const { return {cursor_.run(), cursor_.mission()}; }
  void Next() { more_ = cursor_.Next(); }

 private:
  ResultReader reader_;
  Connection database_;
  Transaction moment_;
  MissionCursor cursor_;
  bool more_;
};

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

  void Add(const std::vector<std::unique_ptr<Source>>& sources) {
    for (const auto& source : sources) {
      AddSessions(source->reader());
      PutNetworks(database_, layout_, source->reader().Networks());
    }
    while (Source* next = FirstOf(sources)) {
      AddMission(next->reader().dir(), next->cursor());
      next->Next();
    }
    for (const auto& source : sources) AddFailures(source->reader());
  }

  const MergeSummary& summary() const { return summary_; }

 private:
  // The one whose next mission comes first in the plan.
  static Source* FirstOf(const std::vector<std::unique_ptr<Source>>& sources) {
    Source* first = nullptr;
    for (const auto& source : sources)
      if (source->more() && (first == nullptr || source->Key() < first->Key())) first = source.get();
    return first;
  }

  void AddSessions(ResultReader& source) {
    for (const Session& session : source.Sessions()) {
      put_session_.Run(session.id, session.host, session.process, session.begun_utc, session.ended_utc);
      for (const auto& [key, value] : session.notes) put_note_.Run(session.id, key, value);
    }
  }

  void AddMission(const std::string& from, const MissionCursor& mission) {
    const sweep::RunId id = mission.Checked();
    if (cursor_.Seek(mission.run(), mission.mission())) {
      cursor_.Checked();
      if (CanonicalBytes(cursor_.record()) != CanonicalBytes(mission.record()) ||
          (!mission.KeepsTimesteps() && cursor_.steps_checksum() != mission.steps_checksum()))
        throw UserError(fmt::format("{}: {} differs from the record of another store that is merged into {}",
                                    from, layout_.Describe(id), dir_));
      ++summary_.present;
      return;
    }
    if (mission.KeepsTimesteps())
      writer_.InsertMission(id, mission.record());
    else
      writer_.InsertWithoutTimesteps(id, mission.record(), mission.steps_checksum());
    if (!std::isnan(mission.wall_s())) writer_.InsertTiming(id, mission.session(), mission.wall_s());
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

bool SameDirectory(const std::string& a, const std::string& b) {
  return std::filesystem::exists(a) && std::filesystem::exists(b) && std::filesystem::equivalent(a, b);
}

}  // namespace

MergeSummary MergeStores(const std::string& out, const std::vector<std::string>& dirs) {
  if (dirs.empty()) throw UserError(fmt::format("{}: nothing to merge into it", out));
  const auto [recipe, layout] = CommonRecipe(dirs);
  // What is in `out` need not be copied; and a reader on it would keep its file in WAL mode.
  std::vector<std::string> others = dirs;
  std::erase_if(others, [&](const std::string& dir) { return SameDirectory(dir, out); });
  StoreFile file(out, recipe, layout);
  try {
    Transaction transaction(file.database(), Transaction::Kind::kWrite);
    CheckWhole(file.database(), layout);
    Target target(file.database(), layout, out);
    for (std::size_t begin = 0; begin < others.size(); begin += kReadAtOnce) {
      std::vector<std::unique_ptr<Source>> sources;
      for (std::size_t i = begin; i < std::min(begin + kReadAtOnce, others.size()); ++i)
        sources.push_back(std::make_unique<Source>(others[i]));
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
