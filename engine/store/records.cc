#include "engine/store/records.h"

#include <fmt/format.h>

#include "engine/core/check.h"
#include "engine/store/columns.h"

namespace ed3r {

RecordWriter::RecordWriter(Connection& database)
    : insert_mission_(database,
                      fmt::format("INSERT INTO missions VALUES ({})", Placeholders<MissionRecord>(2))),
      insert_step_(database,
                   fmt::format("INSERT INTO timesteps VALUES ({})", Placeholders<TimestepRecord>(2))),
      insert_timing_(database, "INSERT OR REPLACE INTO timings VALUES (?, ?, ?, ?)"),
      insert_failure_(database, "INSERT OR REPLACE INTO failures VALUES (?, ?, ?, ?, ?)"),
      delete_failure_(database, "DELETE FROM failures WHERE run = ? AND mission = ?") {}

void RecordWriter::InsertMission(std::int64_t run, std::int64_t mission, const MissionRecord& record) {
  CheckStorable(record);
  insert_mission_.Bind(0, run);
  insert_mission_.Bind(1, mission);
  BindColumns(insert_mission_, 2, record);
  insert_mission_.Run();
  insert_step_.Bind(0, run);
  insert_step_.Bind(1, mission);
  for (const TimestepRecord& step : record.steps) {
    BindColumns(insert_step_, 2, step);
    insert_step_.Run();
  }
  delete_failure_.Run(run, mission);
}

void RecordWriter::InsertTiming(std::int64_t run, std::int64_t mission, std::int64_t session, double wall_s) {
  insert_timing_.Run(run, mission, session, wall_s);
}

void RecordWriter::InsertFailure(std::int64_t run, std::int64_t mission, std::int64_t scenario,
                                 std::uint64_t seed, const std::string& message) {
  insert_failure_.Run(run, mission, scenario, static_cast<std::int64_t>(seed), message);
}

void CheckStorable(const MissionRecord& record) {
  for (std::size_t i = 1; i < record.steps.size(); ++i)
    ED3R_CHECK(record.steps[i - 1].k < record.steps[i].k,
               fmt::format("timestep {} follows timestep {}", record.steps[i].k, record.steps[i - 1].k));
}

RecordReader::RecordReader(Connection& database)
    : select_mission_(database, fmt::format("SELECT {} FROM missions WHERE run = ? AND mission = ?",
                                            ColumnNames<MissionRecord>())),
      select_steps_(database, fmt::format("SELECT {} FROM timesteps WHERE run = ? AND mission = ? ORDER BY k",
                                          ColumnNames<TimestepRecord>())) {}

bool RecordReader::ReadMission(std::int64_t run, std::int64_t mission, MissionRecord& record) {
  select_mission_.Bind(0, run);
  select_mission_.Bind(1, mission);
  const bool found = select_mission_.Step();
  if (found) {
    ReadColumns(select_mission_, 0, record);
    ReadSteps(run, mission, record.steps);
  }
  select_mission_.Reset();
  return found;
}

void RecordReader::ReadSteps(std::int64_t run, std::int64_t mission, std::vector<TimestepRecord>& steps) {
  select_steps_.Bind(0, run);
  select_steps_.Bind(1, mission);
  steps.clear();
  while (select_steps_.Step()) ReadColumns(select_steps_, 0, steps.emplace_back());
  select_steps_.Reset();
}

}  // namespace ed3r
