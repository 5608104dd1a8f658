// The checksums that stand beside each stored mission: whatever reads the mission compares them.
//
// Two of them, so that readers of missions alone need not read timesteps: one over the timesteps, and one over the
// mission's place (stage, arm, number), its columns and the first. SHA-256 in hexadecimal. Whose mission it is tells its
// seal (seals.h).
#pragma once

#include <string>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/columns.h"
#include "engine/store/layout.h"
#include "engine/store/sqlite.h"
#include "engine/sweep/kept_timesteps.h"

namespace ed3r::store {

// The format whose missions have them. What a file says of itself decides, not what columns are in it: those that it should
// have are looked for (shape.h).
inline constexpr int kChecksumsSince = 2;

// Of a file of before: half a sentence for those who read it.
inline constexpr char kNothingToCompare[] = "without checksums (format 1): nothing of it can be compared";

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

  sweep::KeptTimesteps KeptOf(int stage) const;
  // Whether the timesteps of this mission of the stage are in the file. Its checksums are over them in any case.
  bool KeepsTimesteps(int stage, const mission::MissionRecord& record) const;

  std::string StepsChecksum(const std::vector<mission::TimestepRecord>& steps) const;
  std::string MissionChecksum(const RunLayout& layout, const sweep::RunId& id,
                              const mission::MissionRecord& record, const std::string& steps) const;
  Checksums Of(const RunLayout& layout, const sweep::RunId& id, const mission::MissionRecord& record) const;

 private:
  bool checked_;
  std::vector<sweep::KeptTimesteps> kept_;  // by stage
  StoredColumns<mission::MissionRecord> missions_;
  StoredColumns<mission::TimestepRecord> timesteps_;
};

}  // namespace ed3r::store
