// Whole missions into the tables and out of them, with their checksums. Within a transaction of the caller's.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/checksums.h"
#include "engine/store/layout.h"
#include "engine/store/seals.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// InternalError unless the timesteps are numbered upwards, which their key needs.
void CheckStorable(const mission::MissionRecord& record);

// Why a mission has no record. `kind` groups failures: the name of an Invariant, or a word of the scheduler's; "" where a
// file does not tell.
struct Failure {
  std::string kind, message;
};

class RecordWriter {
 public:
  // `layout` must outlive it.
  RecordWriter(Connection& database, const RunLayout& layout);

  // Takes a failure of the same mission away: it has been flown now.
  void InsertMission(const sweep::RunId& id, const mission::MissionRecord& record);
  // The same with its checksums over this file's columns, where they are known. Without timesteps where those are not kept.
  void InsertMission(const sweep::RunId& id, const mission::MissionRecord& record,
                     const Checksums& checksums);
  // One whose timesteps were not kept, by the checksum of those that it had. InternalError where they are kept.
  void InsertWithoutTimesteps(const sweep::RunId& id, const mission::MissionRecord& record,
                              const std::string& steps_checksum);
  void InsertTiming(const sweep::RunId& id, std::int64_t session, double wall_s);
  const RecordTables& Tables() const { return tables_; }
  // Replaces an older failure of the same mission.
  void InsertFailure(const sweep::RunId& id, std::int64_t scenario, std::uint64_t seed,
                     const Failure& failure);

 private:
  void InsertRecord(const sweep::RunId& id, const mission::MissionRecord& record, const Checksums& checksums);

  const RunLayout& layout_;
  RecordTables tables_;
  Seals seals_;
  Statement insert_mission_, insert_step_, insert_timing_, insert_failure_, delete_failure_;
};

struct FailedMission {
  sweep::RunId id;
  std::int64_t scenario = 0;
  std::uint64_t seed = 0;
  std::string kind, message;  // as of Failure
};

// False in files that were begun before failures had kinds and have not been continued since.
bool HasFailureKind(Connection& database);
// In plan order. UserError for one that is not in the plan.
std::vector<FailedMission> ReadFailures(Connection& database, const RunLayout& layout);

enum class Steps { kSkip, kLoad };

// A mission that cannot be believed. `run` and `mission` are its key in the tables.
struct DamagedMission {
  std::int64_t run = 0, mission = 0;
  std::string name;  // "stage online, arm rbs, mission 12"
  std::string what;  // "its timesteps do not match their checksum"
};

// One line: the file, the mission, what is wrong with it and what to do.
std::string DamageText(const std::string& file, const DamagedMission& damage);

// Goes through missions in plan order and compares each with its checksums. UserError where the file does not give them in
// that order.
class MissionCursor {
 public:
  // `where` selects among the columns of the table missions, with `?` for what Seek gives; "" for all. With
  // Steps::kSkip records come without their timesteps, which are then not compared either. `layout` must outlive it.
  MissionCursor(Connection& database, const RunLayout& layout, const std::string& where, Steps steps);

  // To the mission of these keys, if it is there: for a `where` of kOneMission.
  bool Seek(std::int64_t run, std::int64_t mission);
  bool Next();

  std::int64_t run() const { return select_.Int(0); }
  std::int64_t mission() const { return select_.Int(1); }
  std::int64_t session() const { return select_.Int(2); }
  double wall_s() const { return select_.Real(3); }
  const std::string& checksum() const { return checksum_; }  // "" in files of format 1
  const std::string& steps_checksum() const { return steps_checksum_; }
  // Whether its timesteps are in the file, whether or not they are loaded.
  bool KeepsTimesteps() const { return tables_.KeepsTimesteps(id_.stage, record_); }
  const mission::MissionRecord& record() const { return record_; }

  // What is wrong with the present mission, nothing when it is whole.
  bool Damaged() const { return !damage_.what.empty(); }
  const DamagedMission& damage() const { return damage_; }
  // The present mission's place in the plan. UserError with DamageText when it is damaged.
  sweep::RunId Checked() const;

  static constexpr char kOneMission[] = "WHERE missions.run = ? AND missions.mission = ?";

 private:
  static constexpr std::pair<std::int64_t, std::int64_t> kBeforeAll{INT64_MIN, INT64_MIN};

  void CheckOrder();
  void Load();
  std::string WhatIsWrong(const sweep::RunId& id);

  Connection& database_;
  const RunLayout& layout_;
  RecordTables tables_;
  Seals seals_;
  bool with_steps_;
  Statement select_, select_steps_;
  mission::MissionRecord record_;
  std::string checksum_, steps_checksum_, seal_;
  DamagedMission damage_;
  sweep::RunId id_;
  std::pair<std::int64_t, std::int64_t> last_ = kBeforeAll;  // the keys of the mission before
};

}  // namespace ed3r::store
