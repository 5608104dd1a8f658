// Reading results: for studies, status, digest and merge. Everything comes in canonical order: by stage, arm,
// mission, then k. A reader may be open while another process writes: each call sees one moment of the file, and all calls
// the same one while a Moment() lives.
//
// Threads: one reader is used by one thread at a time; open one per thread.
// Errors: UserError when there is no store, or a damaged one. Every mission that is read is compared with its checksum;
// the first that differs is named in the error. FindDamage() goes on and names all.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/mission/record.h"
#include "engine/store/layout.h"
#include "engine/store/networks.h"
#include "engine/store/recipe.h"
#include "engine/store/records.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

struct StoredMission {
  sweep::RunId id;
  mission::MissionRecord record;
  std::int64_t session = 0;  // who flew it
  double wall_s = 0;         // and how long that took
  std::string checksum;      // see checksums.h; "" in files of format 1
  std::string steps_checksum = {};
  bool keeps_timesteps =
      true;  // false: `record` has none, because its sweep leaves them out (kept_timesteps.h)
};

struct Session {
  std::int64_t id = 0;
  std::string host;
  std::int64_t process = 0;
  std::string begun_utc;
  std::string ended_utc;  // "" while it runs, or when it was killed
  std::map<std::string, std::string> notes;
  std::int64_t missions = 0;  // that it flew and that are stored
};

// One arm of one stage. missing = planned - done - failed.
struct ArmStatus {
  std::string stage, arm;
  std::int64_t planned = 0, done = 0, failed = 0, missing = 0;
  double simulated_s = 0, wall_s = 0;  // of the missions done; wall time summed over threads
};

// A results file without tables, as a writer leaves it that was killed at its very start.
class NoResultsYet : public UserError {
 public:
  using UserError::UserError;
};

inline constexpr std::uintmax_t kQuicklyComparedBytes = 50'000'000;

class ResultReader {
 public:
  explicit ResultReader(const std::string& dir);

  const std::string& dir() const { return dir_; }

  // Must not outlive the reader.
  [[nodiscard]] Transaction Moment() { return {database_, Transaction::Kind::kRead}; }

  // UserError where the plan has grown since this reader was opened: arms may have other numbers now. Whatever reads missions asks it.
  void CheckPlan();

  // UserError where the directory holds another file now than the one that this reader reads.
  void CheckNotReplaced() const { database_.CheckNotReplaced(); }

  const RunLayout& Layout() const { return layout_; }
  const Recipe& StoredRecipe() const { return recipe_; }  // without notes and files: see Sessions()
  std::vector<InputFile> Files();
  FlownNetworks Networks();
  void CheckViews();  // views.h

  // Of the file: 1 has no checksums.
  int Format() const { return format_; }

  // The number of a stage's arm. UserError where it has none of this name.
  int ArmNamed(int stage, const std::string& name) const;

  // The columns that the file has.
  const RecordTables& Tables() const { return *tables_; }

  std::vector<sweep::RunId> Stored();
  std::int64_t CountMissions();     // rows, whatever is in them
  std::vector<ArmStatus> Status();  // counts keys alone: FindDamage() compares what they hold
  std::vector<FailedMission> Failures();
  std::vector<Session> Sessions();  // in order of their begin

  // With Steps::kSkip the records come without their timesteps. `visit` must not call this reader.
  using MissionVisitor = std::function<void(const StoredMission&)>;
  void ForEachMission(Steps steps, const MissionVisitor& visit);
  void ForEachMission(int stage, int arm, Steps steps, const MissionVisitor& visit);
  // Missions first, first + 1, ..., end - 1 of the arm.
  void ForEachMission(int stage, int arm, int first, int end, Steps steps, const MissionVisitor& visit);

  // UserError unless the timesteps of all missions of the stage are stored.
  void NeedTimesteps(int stage) const;

  // Whether a flight is the stored one, timesteps included, wherever those are kept or not. `stored` has been loaded with
  // its timesteps.
  bool IsStored(const mission::MissionRecord& flown, const StoredMission& stored) const;

  // Every timestep of one arm, for training and pooled figures. UserError where some are not stored.
  void ForEachTimestep(int stage, int arm,
                       const std::function<void(int mission, const mission::TimestepRecord&)>& visit);

  // With timesteps. UserError when it is not in the plan, or not stored (yet, or because it failed).
  StoredMission LoadMission(const sweep::RunId& id);

  // The digest (digest.h) of all that is stored, of which everything has been compared: UserError names the first damaged
  // mission. `visit` is called for each, with its timesteps, and must not call this reader.
  using RecordVisitor = std::function<void(const sweep::RunId&, const mission::MissionRecord&)>;
  std::string CheckWhole(const RecordVisitor& visit = {});

  // Every mission that does not match its checksums or is not in the plan. Reads everything.
  std::vector<DamagedMission> FindDamage();
  // Whether that takes about a second at most: a look at a run must not take long.
  bool IsQuicklyCompared() const;

 private:
  // `run`: whose missions alone are asked for.
  void Visit(const std::string& where, std::optional<std::int64_t> run, Steps steps,
             const MissionVisitor& visit);

  std::string dir_;
  Connection database_;
  int format_ = 0;
  std::optional<RecordTables> tables_;
  RunLayout layout_;
  Recipe recipe_;
};

}  // namespace ed3r::store
