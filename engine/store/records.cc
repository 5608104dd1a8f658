#include "engine/store/records.h"

#include <fmt/format.h>

#include <limits>

#include "engine/core/check.h"
#include "engine/store/columns.h"
#include "engine/store/schema.h"

namespace ed3r::store {

RecordWriter::RecordWriter(Connection& database, const RunLayout& layout)
    : layout_(layout),
      tables_(database),
      seals_(database),
      insert_mission_(
          database,
          fmt::format("INSERT INTO missions (run, mission, checksum, steps_checksum, {}{}) VALUES ({}{})",
                      ColumnNames<mission::MissionRecord>(), seals_.there() ? ", seal" : "",
                      Placeholders<mission::MissionRecord>(4), seals_.there() ? ", ?" : "")),
      insert_step_(database, fmt::format("INSERT INTO timesteps (run, mission, {}) VALUES ({})",
                                         ColumnNames<mission::TimestepRecord>(),
                                         Placeholders<mission::TimestepRecord>(2))),
      insert_timing_(database,
                     "INSERT OR REPLACE INTO timings (run, mission, session, wall_s) VALUES (?, ?, ?, ?)"),
      insert_failure_(database,
                      "INSERT OR REPLACE INTO failures (run, mission, scenario, seed, kind, message) "
                      "VALUES (?, ?, ?, ?, ?, ?)"),
      delete_failure_(database, "DELETE FROM failures WHERE run = ? AND mission = ?") {}

void RecordWriter::InsertMission(const sweep::RunId& id, const mission::MissionRecord& record) {
  InsertMission(id, record, tables_.Of(layout_, id, record));
}

void RecordWriter::InsertMission(const sweep::RunId& id, const mission::MissionRecord& record,
                                 const Checksums& checksums) {
  CheckStorable(record);
  InsertRecord(id, record, checksums);
  if (!tables_.KeepsTimesteps(id.stage, record)) return;
  insert_step_.Bind(0, layout_.RunIndex(id));
  insert_step_.Bind(1, std::int64_t{id.mission});
  for (const mission::TimestepRecord& step : record.steps) {
    BindColumns(insert_step_, 2, step);
    insert_step_.Run();
  }
}

void RecordWriter::InsertWithoutTimesteps(const sweep::RunId& id, const mission::MissionRecord& record,
                                          const std::string& steps_checksum) {
  ED3R_CHECK(!tables_.KeepsTimesteps(id.stage, record), layout_.Describe(id));
  InsertRecord(id, record, {tables_.MissionChecksum(layout_, id, record, steps_checksum), steps_checksum});
}

void RecordWriter::InsertRecord(const sweep::RunId& id, const mission::MissionRecord& record,
                                const Checksums& checksums) {
  const std::int64_t run = layout_.RunIndex(id), mission = id.mission;
  insert_mission_.Bind(0, run);
  insert_mission_.Bind(1, mission);
  insert_mission_.Bind(2, checksums.mission);
  insert_mission_.Bind(3, checksums.steps);
  BindColumns(insert_mission_, 4, record);
  if (seals_.there())
    insert_mission_.Bind(4 + static_cast<int>(ColumnsOf<mission::MissionRecord>().size()),
                         seals_.Of(checksums.mission, run, record.network));
  insert_mission_.Run();
  delete_failure_.Run(run, mission);
}

void RecordWriter::InsertTiming(const sweep::RunId& id, std::int64_t session, double wall_s) {
  insert_timing_.Run(layout_.RunIndex(id), std::int64_t{id.mission}, session, wall_s);
}

void RecordWriter::InsertFailure(const sweep::RunId& id, std::int64_t scenario, std::uint64_t seed,
                                 const Failure& failure) {
  insert_failure_.Run(layout_.RunIndex(id), std::int64_t{id.mission}, scenario,
                      static_cast<std::int64_t>(seed), failure.kind, failure.message);
}

void CheckStorable(const mission::MissionRecord& record) {
  for (std::size_t i = 1; i < record.steps.size(); ++i)
    ED3R_CHECK(record.steps[i - 1].k < record.steps[i].k,
               fmt::format("timestep {} follows timestep {}", record.steps[i].k, record.steps[i - 1].k));
}

std::string DamageText(const std::string& file, const DamagedMission& damage) {
  return fmt::format(
      "{}: {} is damaged: {}; 'ed3r verify DIR' names all that is damaged, 'ed3r run SWEEP --repair' "
      "flies it again",
      file, damage.name, damage.what);
}

bool HasFailureKind(Connection& database) {
  return database.Int("SELECT count(*) FROM pragma_table_info('failures') WHERE name = 'kind'") > 0;
}

std::vector<FailedMission> ReadFailures(Connection& database, const RunLayout& layout) {
  const bool with_kind = HasFailureKind(database);
  Statement select(database,
                   fmt::format("SELECT run, mission, scenario, seed, {}, message FROM failures ORDER BY "
                               "run, mission",
                               with_kind ? "kind" : "''"));
  std::vector<FailedMission> failures;
  while (select.Step()) {
    const std::optional<sweep::RunId> id = layout.Place(select.Int(0), select.Int(1));
    if (!id)
      throw UserError(DamageText(
          database.file(), {select.Int(0), select.Int(1), layout.DescribeKeys(select.Int(0), select.Int(1)),
                            "it is said to have failed, but the plan has no such mission"}));
    failures.push_back(
        {*id, select.Int(2), static_cast<std::uint64_t>(select.Int(3)), select.Text(4), select.Text(5)});
  }
  return failures;
}

MissionCursor::MissionCursor(Connection& database, const RunLayout& layout, const std::string& where,
                             Steps steps)
    : database_(database),
      layout_(layout),
      tables_(database),
      seals_(database),
      with_steps_(steps == Steps::kLoad),
      select_(database, fmt::format("SELECT missions.run, missions.mission, session, wall_s, {}, {}, {} FROM "
                                    "missions {} LEFT JOIN "
                                    "timings USING (run, mission) {} ORDER BY missions.run, missions.mission",
                                    tables_.checked() ? "checksum, steps_checksum" : "'', ''",
                                    seals_.there() ? "seal" : "''", tables_.missions().selection(),
                                    kAlongTheKey, where)),
      select_steps_(database, fmt::format("SELECT {} FROM timesteps WHERE run = ? AND mission = ? ORDER BY k",
                                          tables_.timesteps().selection())) {}

bool MissionCursor::Seek(std::int64_t run, std::int64_t mission) {
  select_.Reset();
  last_ = kBeforeAll;
  select_.Bind(0, run);
  select_.Bind(1, mission);
  return Next();
}

bool MissionCursor::Next() {
  if (!select_.Step()) return false;
  Load();
  return true;
}

// A tree that leads astray shows in its keys: rows twice, rows that another place of it holds.
void MissionCursor::CheckOrder() {
  const std::pair key{run(), mission()};
  if (key <= last_)
    throw UserError(
        fmt::format("{}: the file is damaged: {} is where a mission after {} belongs; it cannot be repaired: "
                    "fly it again "
                    "into another --out",
                    database_.file(), layout_.DescribeKeys(key.first, key.second),
                    layout_.DescribeKeys(last_.first, last_.second)));
  last_ = key;
}

void MissionCursor::Load() {
  CheckOrder();
  checksum_ = select_.Text(4);
  steps_checksum_ = select_.Text(5);
  seal_ = select_.Text(6);
  ReadColumns(select_, 7, record_);
  record_.steps.clear();
  if (with_steps_) {
    select_steps_.Bind(0, run());
    select_steps_.Bind(1, mission());
    while (select_steps_.Step()) ReadColumns(select_steps_, 0, record_.steps.emplace_back());
    select_steps_.Reset();
  }
  damage_ = {run(), mission(), "", ""};
  const std::optional<sweep::RunId> place = layout_.Place(run(), mission());
  if (!place) {
    damage_.name = layout_.DescribeKeys(run(), mission());
    damage_.what = "the plan has no such mission";
    return;
  }
  id_ = *place;
  damage_.what = WhatIsWrong(id_);
  if (Damaged()) damage_.name = layout_.Describe(id_);
}

std::string MissionCursor::WhatIsWrong(const sweep::RunId& id) {
  if (!tables_.checked()) return "";
  if (tables_.MissionChecksum(layout_, id, record_, steps_checksum_) != checksum_)
    return "its record does not match its checksum";
  if (seals_.there() && !seals_.Fits(checksum_, run(), record_.network, seal_))
    return "its seal is not of this run's recipe and networks: a mission of another run, or a damaged seal";
  if (!with_steps_) return "";
  if (!tables_.KeepsTimesteps(id.stage, record_))
    return record_.steps.empty() ? "" : "it has timesteps, which its sweep leaves out (store.timesteps)";
  if (tables_.StepsChecksum(record_.steps) != steps_checksum_)
    return "its timesteps do not match their checksum";
  return "";
}

sweep::RunId MissionCursor::Checked() const {
  if (Damaged()) throw UserError(DamageText(database_.file(), damage_));
  return id_;
}

}  // namespace ed3r::store
