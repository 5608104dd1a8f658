#include "engine/store/shards/merge.h"

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
#include "engine/store/growth.h"
#include "engine/store/part_of_run.h"
#include "engine/store/reader.h"
#include "engine/store/records.h"
#include "engine/store/schema.h"
#include "engine/store/shards/common_run.h"
#include "engine/store/shards/joined_missions.h"
#include "engine/store/shards/shards.h"
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
                     "INSERT INTO sessions (session, host, process, begun_utc, ended_utc) VALUES (?, ?, ?, "
                     "?, nullif(?, '')) ON CONFLICT DO UPDATE "
                     "SET ended_utc = coalesce(excluded.ended_utc, ended_utc)"),
        put_note_(database, "INSERT OR REPLACE INTO session_notes (session, key, value) VALUES (?, ?, ?)"),
        has_mission_(database, "SELECT 1 FROM missions WHERE run = ? AND mission = ?"),
        holds_missions_(database.Int("SELECT count(*) FROM (SELECT 1 FROM missions LIMIT 1)") > 0) {}

  // Stores of one plan, which is the target's or has grown into it.
  void Add(const std::vector<std::unique_ptr<ResultReader>>& sources) {
    if (sources.empty()) return;
    arms_here_ = ArmsAfterGrowth(sources.front()->Layout(), layout_);
    last_ = {-1, -1, -1};
    std::vector<bool> same_columns;
    for (const auto& source : sources) {
      AddSessions(*source);
      AddNetworks(source->Networks());
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

  void AddNetworks(FlownNetworks networks) {
    for (NetworkUse& use : networks.uses) use.arm = ArmHere(use.stage, use.arm);
    PutNetworks(database_, layout_, networks);
  }

  int ArmHere(int stage, int arm) const {
    return arms_here_.at(static_cast<std::size_t>(stage)).at(static_cast<std::size_t>(arm));
  }

  sweep::RunId Here(sweep::RunId id) const {
    id.arm = ArmHere(id.stage, id.arm);
    return id;
  }

  void AddMission(const std::string& from, bool same_columns, const ComparedMission& mission) {
    const sweep::RunId id = Here(mission.id);
    // In plan order, what an empty file holds of a mission is what was put just now.
    const bool may_be_there = holds_missions_ || id == last_;
    last_ = id;
    if (may_be_there && cursor_.Seek(layout_.RunIndex(id), id.mission)) {
      if (!IsSame(same_columns, mission))
        throw UserError(fmt::format("{}: {} differs from the record of another store that is merged into {}",
                                    from, layout_.Describe(id), dir_));
      ++summary_.present;
      return;
    }
    if (same_columns)
      writer_.InsertMission(id, mission.record, mission.checksums);
    else if (mission.keeps_timesteps)
      writer_.InsertMission(id, mission.record);
    else
      writer_.InsertWithoutTimesteps(id, mission.record, mission.checksums.steps);
    if (!std::isnan(mission.wall_s)) writer_.InsertTiming(id, mission.session, mission.wall_s);
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
      const sweep::RunId id = Here(failure.id);
      has_mission_.Bind(0, layout_.RunIndex(id));
      has_mission_.Bind(1, std::int64_t{id.mission});
      const bool flown = has_mission_.Step();
      has_mission_.Reset();
      if (!flown) writer_.InsertFailure(id, failure.scenario, failure.seed, {failure.kind, failure.message});
    }
  }

  Connection& database_;
  const RunLayout& layout_;
  std::string dir_;
  RecordWriter writer_;
  MissionCursor cursor_;
  Statement put_session_, put_note_, has_mission_;
  bool holds_missions_;                      // from before, or from other stores than those that are read now
  std::vector<std::vector<int>> arms_here_;  // of the stores that are read now, by stage
  sweep::RunId last_{-1, -1, -1};            // the mission that was added last
  MergeSummary summary_;
};

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

struct ToMerge {
  Recipe recipe;
  RunLayout layout;
  std::vector<std::vector<std::string>> by_plan;
};

// Since they were looked at one may have grown, or another run have taken its place.
void CheckAsBefore(const ToMerge& all, const std::vector<std::unique_ptr<ResultReader>>& sources) {
  for (const auto& source : sources) {
    const Recipe& recipe = source->StoredRecipe();
    if (recipe.plan_text != sources.front()->StoredRecipe().plan_text ||
        !FindPlan(all.recipe, all.layout, *source).Counts())
      throw UserError(
          fmt::format("{}: has changed since the merge began; give the same command again", source->dir()));
  }
}

void AddAll(Target& target, const ToMerge& all, const std::vector<std::string>& dirs) {
  for (std::size_t begin = 0; begin < dirs.size(); begin += kReadAtOnce) {
    std::vector<std::unique_ptr<ResultReader>> sources;
    for (std::size_t i = begin; i < std::min(begin + kReadAtOnce, dirs.size()); ++i)
      sources.push_back(std::make_unique<ResultReader>(dirs[i]));
    CheckAsBefore(all, sources);
    target.Add(sources);
  }
}

// With tables: a killed merge leaves a file without.
bool IsStore(const std::string& dir) {
  if (!HoldsResults(dir)) return false;
  try {
    const ResultReader reader(dir);
    return true;
  } catch (const NoResultsYet&) {
    return false;
  }
}

// A reader on `out` must be gone before it is written: it would keep the file in WAL mode.
ToMerge LookAt(const std::string& out, std::vector<std::string> dirs, OtherCode other_code) {
  if (IsStore(out)) dirs.push_back(out);
  const CommonRun run(dirs, other_code);
  ToMerge all{run.TheRecipe(), run.Layout(), run.ByPlan()};
  // What is in `out` need not be copied.
  for (std::vector<std::string>& of_plan : all.by_plan)
    std::erase_if(of_plan, [&](const std::string& dir) { return SameStore(dir, out); });
  return all;
}

}  // namespace

MergeSummary MergeStores(const std::string& out, const std::vector<std::string>& dirs, OtherCode other_code) {
  if (dirs.empty()) throw UserError(fmt::format("{}: nothing to merge into it", out));
  const ToMerge all = LookAt(out, dirs, other_code);
  StoreFile file(out, all.recipe, all.layout, {.other_code = OtherCode::kAccept});  // looked at already
  try {
    Transaction transaction(file.database(), Transaction::Kind::kWrite);
    WriteFirstPage(file.database());
    file.TakeUp(all.recipe, all.layout);
    if (file.grown().empty()) CheckWhole(file.database(), all.layout);  // else looked through before it grows
    Target target(file.database(), all.layout, out);
    for (const std::vector<std::string>& of_plan : all.by_plan) AddAll(target, all, of_plan);
    MergeSummary summary = target.summary();
    summary.failed = file.database().Int("SELECT count(*) FROM failures");
    file.CheckInPlace();
    transaction.Commit();
    return summary;
  } catch (...) {
    file.Discard();
    throw;
  }
}

}  // namespace ed3r::store
