// Whole missions into the tables and out of them. Within a transaction of the caller's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/sqlite.h"

namespace ed3r {

// InternalError unless the timesteps are numbered upwards, which their key needs.
void CheckStorable(const MissionRecord& record);

class RecordWriter {
 public:
  explicit RecordWriter(Connection& database);

  // Takes a failure of the same mission away: it has been flown now.
  void InsertMission(std::int64_t run, std::int64_t mission, const MissionRecord& record);
  void InsertTiming(std::int64_t run, std::int64_t mission, std::int64_t session, double wall_s);
  // Replaces an older failure of the same mission.
  void InsertFailure(std::int64_t run, std::int64_t mission, std::int64_t scenario, std::uint64_t seed,
                     const std::string& message);

 private:
  Statement insert_mission_, insert_step_, insert_timing_, insert_failure_, delete_failure_;
};

class RecordReader {
 public:
  explicit RecordReader(Connection& database);

  // With timesteps; false when it is not stored.
  bool ReadMission(std::int64_t run, std::int64_t mission, MissionRecord& record);
  void ReadSteps(std::int64_t run, std::int64_t mission, std::vector<TimestepRecord>& steps);

 private:
  Statement select_mission_, select_steps_;
};

}  // namespace ed3r
