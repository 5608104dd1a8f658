// The checksums that stand beside each stored mission: whatever reads the mission compares them.
//
// Two are over what was flown, so that readers of missions alone need not read timesteps: one over the timesteps, and one
// over the mission's place (stage, arm, number), its columns and the first. The third, the seal, is over the second and
// the recipe that the mission was flown by, so that a mission of another run is known, whole as it is. Digests are made of
// the second alone: seals change with what a run grows by, results do not. SHA-256 in hexadecimal.
#pragma once

#include <string>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/columns.h"
#include "engine/store/layout.h"
#include "engine/store/sqlite.h"
#include "engine/sweep/kept_timesteps.h"

namespace ed3r::store {

struct Checksums {
  std::string mission, steps;
  bool operator==(const Checksums&) const = default;
};

// The tables missions and timesteps of one file: their columns, and the checksums of records in it.
// Threads: const calls from any thread.
class RecordTables {
 public:
  // UserError for a file with a column that this code does not know.
  explicit RecordTables(Connection& database);

  const StoredColumns<mission::MissionRecord>& missions() const { return missions_; }
  const StoredColumns<mission::TimestepRecord>& timesteps() const { return timesteps_; }
  bool complete() const { return missions_.complete() && timesteps_.complete(); }
  // False in a file of format 1, whose missions have no checksums.
  bool checked() const { return checked_; }
  // False in a file that was begun before missions had seals.
  bool sealed() const { return sealed_; }

  sweep::KeptTimesteps KeptOf(int stage) const;
  // Whether the timesteps of this mission of the stage are in the file. Its checksums are over them in any case.
  bool KeepsTimesteps(int stage, const mission::MissionRecord& record) const;

  std::string StepsChecksum(const std::vector<mission::TimestepRecord>& steps) const;
  std::string MissionChecksum(const RunLayout& layout, const sweep::RunId& id,
                              const mission::MissionRecord& record, const std::string& steps) const;
  Checksums Of(const RunLayout& layout, const sweep::RunId& id, const mission::MissionRecord& record) const;

  // Of a mission with this checksum, by the recipe that the file has now.
  std::string Seal(const std::string& mission_checksum) const;
  // Whether it is one by any recipe that the file has had.
  bool IsSealed(const std::string& mission_checksum, const std::string& seal) const;

 private:
  bool checked_, sealed_;
  std::vector<std::string> origins_;        // of the recipes that the file has had, the present one last
  std::vector<sweep::KeptTimesteps> kept_;  // by stage
  StoredColumns<mission::MissionRecord> missions_;
  StoredColumns<mission::TimestepRecord> timesteps_;
};

}  // namespace ed3r::store
