#include "engine/store/reader.h"

#include <fmt/format.h>

#include <filesystem>

#include "engine/core/check.h"
#include "engine/store/columns.h"
#include "engine/store/records.h"
#include "engine/store/schema.h"

namespace ed3r {
namespace {

std::string ExistingFile(const std::string& dir) {
  const std::filesystem::path file = std::filesystem::path(dir) / kResultsFile;
  if (!std::filesystem::is_directory(dir)) throw UserError(fmt::format("{}: no such directory", dir));
  if (!std::filesystem::exists(file))
    throw UserError(fmt::format("{}: no results in it ({} is missing)", dir, kResultsFile));
  return file.string();
}

RunId ReadId(const Statement& row) {
  return {static_cast<int>(row.Int(0)), static_cast<int>(row.Int(1)), static_cast<int>(row.Int(2))};
}

}  // namespace

ResultReader::ResultReader(const std::string& dir)
    : dir_(dir), database_(ExistingFile(dir), Connection::Access::kReadOnly) {
  if (CheckFile(database_) == FileKind::kEmpty)
    throw UserError(fmt::format("{}: no results in it yet ({} is empty)", dir, kResultsFile));
  layout_ = ReadLayout(database_);
  recipe_ = ReadRecipe(database_);
}

std::vector<RunId> ResultReader::Stored() { return ReadStored(database_); }

std::vector<ArmStatus> ResultReader::Status() {
  Statement select(database_, R"(
    SELECT stages.name, runs.name, stages.missions,
      (SELECT count(*) FROM missions WHERE missions.run = runs.run),
      (SELECT count(*) FROM failures WHERE failures.run = runs.run),
      (SELECT total(duration_s) FROM missions WHERE missions.run = runs.run),
      (SELECT total(wall_s) FROM timings WHERE timings.run = runs.run)
    FROM runs JOIN stages USING (stage) ORDER BY run)");
  std::vector<ArmStatus> status;
  while (select.Step()) {
    ArmStatus& arm = status.emplace_back();
    arm.stage = select.Text(0);
    arm.arm = select.Text(1);
    arm.planned = select.Int(2);
    arm.done = select.Int(3);
    arm.failed = select.Int(4);
    arm.missing = arm.planned - arm.done - arm.failed;
    arm.simulated_s = select.Real(5);
    arm.wall_s = select.Real(6);
  }
  return status;
}

std::vector<FailedMission> ResultReader::Failures() {
  Statement select(database_,
                   "SELECT stage, arm, mission, scenario, seed, message FROM failures JOIN runs USING (run) "
                   "ORDER BY run, mission");
  std::vector<FailedMission> failures;
  while (select.Step())
    failures.push_back(
        {ReadId(select), select.Int(3), static_cast<std::uint64_t>(select.Int(4)), select.Text(5)});
  return failures;
}

std::vector<Session> ResultReader::Sessions() {
  const Transaction moment(database_, Transaction::Kind::kRead);
  std::vector<Session> sessions;
  Statement select(database_,
                   "SELECT session, host, process, begun_utc, ended_utc, flown FROM sessions LEFT JOIN "
                   "(SELECT session, count(*) AS flown FROM timings GROUP BY session) USING (session) "
                   "ORDER BY begun_utc, session");
  while (select.Step())
    sessions.push_back(
        {select.Int(0), select.Text(1), select.Int(2), select.Text(3), select.Text(4), {}, select.Int(5)});
  Statement notes(database_, "SELECT key, value FROM session_notes WHERE session = ?");
  for (Session& session : sessions) {
    notes.Bind(0, session.id);
    while (notes.Step()) session.notes[notes.Text(0)] = notes.Text(1);
    notes.Reset();
  }
  return sessions;
}

void ResultReader::ForEachMission(Steps steps, const MissionVisitor& visit) { Visit("", steps, visit); }

void ResultReader::ForEachMission(int stage, int arm, Steps steps, const MissionVisitor& visit) {
  Visit(fmt::format("WHERE missions.run = {}", layout_.RunIndex(stage, arm)), steps, visit);
}

void ResultReader::Visit(const std::string& where, Steps steps, const MissionVisitor& visit) {
  const Transaction moment(database_, Transaction::Kind::kRead);
  Statement select(database_,
                   fmt::format("SELECT stage, runs.arm, mission, run, session, wall_s, {} FROM missions "
                               "JOIN runs USING (run) LEFT JOIN timings USING (run, mission) {} "
                               "ORDER BY run, mission",
                               ColumnNames<MissionRecord>(), where));
  RecordReader reader(database_);
  while (select.Step()) {
    StoredMission mission;
    mission.id = ReadId(select);
    mission.session = select.Int(4);
    mission.wall_s = select.Real(5);
    ReadColumns(select, 6, mission.record);
    if (steps == Steps::kLoad) reader.ReadSteps(select.Int(3), mission.id.mission, mission.record.steps);
    visit(mission);
  }
}

void ResultReader::ForEachTimestep(int stage, int arm,
                                   const std::function<void(int, const TimestepRecord&)>& visit) {
  Statement select(database_,
                   fmt::format("SELECT mission, {} FROM timesteps WHERE run = {} ORDER BY mission, k",
                               ColumnNames<TimestepRecord>(), layout_.RunIndex(stage, arm)));
  TimestepRecord step;
  while (select.Step()) {
    ReadColumns(select, 1, step);
    visit(static_cast<int>(select.Int(0)), step);
  }
}

StoredMission ResultReader::LoadMission(const RunId& id) {
  if (!layout_.Contains(id))
    throw UserError(fmt::format("{}: no mission {} of arm {} of stage {} in the plan", dir_, id.mission,
                                id.arm, id.stage));
  StoredMission loaded;
  bool found = false;
  Visit(fmt::format("WHERE missions.run = {} AND missions.mission = {}", layout_.RunIndex(id), id.mission),
        Steps::kLoad, [&](const StoredMission& mission) {
          loaded = mission;
          found = true;
        });
  if (!found) throw UserError(fmt::format("{}: {} is not stored", dir_, layout_.Describe(id)));
  return loaded;
}

}  // namespace ed3r
