#include "engine/store/reader.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "engine/core/check.h"
#include "engine/store/damage.h"
#include "engine/store/digest.h"
#include "engine/store/directory_lock.h"
#include "engine/store/schema.h"
#include "engine/store/sqlite_errors.h"
#include "engine/store/store_file.h"
#include "engine/store/views.h"

namespace ed3r::store {
namespace {

std::string ExistingFile(const std::string& dir) {
  const std::filesystem::path file = std::filesystem::path(dir) / kResultsFile;
  if (!std::filesystem::is_directory(dir)) throw UserError(fmt::format("{}: no such directory", dir));
  if (!std::filesystem::exists(file))
    throw UserError(fmt::format("{}: no results in it ({} is missing)", dir, kResultsFile));
  return file.string();
}

// A file that can be read: one that a killed writer left half committed is rolled back first.
Connection OpenToRead(const std::string& dir) {
  const std::string file = ExistingFile(dir);
  try {
    Connection database(file, Connection::Access::kReadOnly);
    database.Int("SELECT count(*) FROM sqlite_schema");
    return database;
  } catch (const UnfinishedCommitError&) {
    FinishCommit(dir);
    return Connection(file, Connection::Access::kReadOnly);
  }
}

}  // namespace

ResultReader::ResultReader(const std::string& dir) : dir_(dir), database_(OpenToRead(dir)) {
  if (CheckFile(database_, FileUse::kRead) == FileKind::kEmpty)
    throw NoResultsYet(fmt::format("{}: no results in it yet ({} is empty)", dir, kResultsFile));
  format_ = static_cast<int>(database_.Int("PRAGMA user_version"));
  tables_.emplace(database_);
  const Transaction moment(database_, Transaction::Kind::kRead);
  layout_ = ReadLayout(database_);
  recipe_ = ReadRecipe(database_);
}

bool ResultReader::IsQuicklyCompared() const {
  return std::filesystem::file_size(database_.file()) <= kQuicklyComparedBytes;
}

void ResultReader::CheckPlan() {
  Statement plan(database_, "SELECT value FROM recipe WHERE key = 'plan'");
  if (!plan.Step() || plan.Text(0) != recipe_.plan_text)
    throw UserError(fmt::format(
        "{}: its plan has grown since it was opened; open it again (the same command does)", dir_));
}

std::vector<InputFile> ResultReader::Files() { return ReadFiles(database_); }

void ResultReader::CheckViews() {
  const Transaction moment(database_, Transaction::Kind::kRead);
  store::CheckViews(database_);
}

FlownNetworks ResultReader::Networks() {
  const Transaction moment(database_, Transaction::Kind::kRead);
  CheckPlan();
  return ReadNetworks(database_, layout_);
}

int ResultReader::ArmNamed(int stage, const std::string& name) const {
  const RunLayout::Stage& there = layout_.stages.at(static_cast<std::size_t>(stage));
  for (std::size_t arm = 0; arm < there.arms.size(); ++arm)
    if (there.arms[arm].name == name) return static_cast<int>(arm);
  throw UserError(
      fmt::format("{}: stage {} has no arm {} there; give a run of the same sweep", dir_, there.name, name));
}

std::vector<sweep::RunId> ResultReader::Stored() {
  const Transaction moment(database_, Transaction::Kind::kRead);
  CheckPlan();
  return ReadStored(database_, layout_);
}

std::int64_t ResultReader::CountMissions() {
  return database_.Int("SELECT count(*) FROM missions NOT INDEXED");
}

std::vector<ArmStatus> ResultReader::Status() {
  const Transaction moment(database_, Transaction::Kind::kRead);
  CheckPlan();
  std::vector<ArmStatus> status;
  for (const RunLayout::Stage& stage : layout_.stages)
    for (const RunLayout::Arm& arm : stage.arms)
      status.push_back({.stage = stage.name, .arm = arm.name, .planned = stage.missions});
  MissionCursor cursor(database_, layout_, "", Steps::kSkip);
  while (cursor.Next()) {
    const std::optional<sweep::RunId> id = layout_.Place(cursor.run(), cursor.mission());
    if (!id) continue;  // FindDamage() tells
    ArmStatus& arm = status[static_cast<std::size_t>(layout_.RunIndex(*id))];
    ++arm.done;
    arm.simulated_s += cursor.record().duration_s;
    if (!std::isnan(cursor.wall_s())) arm.wall_s += cursor.wall_s();
  }
  for (const FailedMission& failure : Failures())
    ++status[static_cast<std::size_t>(layout_.RunIndex(failure.id))].failed;
  for (ArmStatus& arm : status) arm.missing = arm.planned - arm.done - arm.failed;
  return status;
}

std::vector<FailedMission> ResultReader::Failures() {
  const Transaction moment(database_, Transaction::Kind::kRead);
  CheckPlan();
  return ReadFailures(database_, layout_);
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

void ResultReader::ForEachMission(Steps steps, const MissionVisitor& visit) { Visit("", {}, steps, visit); }

void ResultReader::ForEachMission(int stage, int arm, Steps steps, const MissionVisitor& visit) {
  const std::int64_t run = layout_.RunIndex(stage, arm);
  Visit(fmt::format("WHERE missions.run = {}", run), run, steps, visit);
}

void ResultReader::ForEachMission(int stage, int arm, int first, int end, Steps steps,
                                  const MissionVisitor& visit) {
  const std::int64_t run = layout_.RunIndex(stage, arm);
  Visit(fmt::format("WHERE missions.run = {} AND missions.mission >= {} AND missions.mission < {}", run,
                    first, end),
        run, steps, visit);
}

void ResultReader::Visit(const std::string& where, std::optional<std::int64_t> run, Steps steps,
                         const MissionVisitor& visit) {
  const Transaction moment(database_, Transaction::Kind::kRead);
  CheckPlan();
  MissionCursor cursor(database_, layout_, where, steps);
  while (cursor.Next()) {
    if (run && cursor.run() != *run)
      throw UserError(fmt::format(
          "{}: the file is damaged: {} is among the missions of another arm; it cannot be repaired: fly it "
          "again into another --out",
          database_.file(), layout_.DescribeKeys(cursor.run(), cursor.mission())));
    visit({cursor.Checked(), cursor.record(), cursor.session(), cursor.wall_s(), cursor.checksum(),
           cursor.steps_checksum(), cursor.KeepsTimesteps()});
  }
}

void ResultReader::NeedTimesteps(int stage) const {
  const sweep::KeptTimesteps kept = tables_->KeptOf(stage);
  if (kept == sweep::KeptTimesteps::kAll) return;
  throw UserError(
      fmt::format("{}: stage {}: the timesteps are needed, and its sweep says store: {{timesteps: {}}}; fly "
                  "it into another --out with store: {{timesteps: all}}",
                  dir_, layout_.stages.at(static_cast<std::size_t>(stage)).name, NameOf(kept)));
}

bool ResultReader::IsStored(const mission::MissionRecord& flown, const StoredMission& stored) const {
  if (stored.keeps_timesteps) return DigestOf(flown) == DigestOf(stored.record);
  return tables_->Of(layout_, stored.id, flown) == Checksums{stored.checksum, stored.steps_checksum};
}

void ResultReader::ForEachTimestep(int stage, int arm,
                                   const std::function<void(int, const mission::TimestepRecord&)>& visit) {
  NeedTimesteps(stage);
  ForEachMission(stage, arm, Steps::kLoad, [&](const StoredMission& mission) {
    for (const mission::TimestepRecord& step : mission.record.steps) visit(mission.id.mission, step);
  });
}

StoredMission ResultReader::LoadMission(const sweep::RunId& id) {
  if (!layout_.Contains(id))
    throw UserError(fmt::format("{}: no mission {} of arm {} of stage {} in the plan", dir_, id.mission,
                                id.arm, id.stage));
  std::optional<StoredMission> loaded;
  const std::int64_t run = layout_.RunIndex(id);
  Visit(fmt::format("WHERE missions.run = {} AND missions.mission = {}", run, id.mission), run, Steps::kLoad,
        [&](const StoredMission& mission) { loaded = mission; });
  if (!loaded) throw UserError(fmt::format("{}: {} is not stored", dir_, layout_.Describe(id)));
  return *loaded;
}

std::string ResultReader::CheckWhole(const RecordVisitor& visit) {
  const Transaction moment(database_, Transaction::Kind::kRead);
  CheckPlan();
  ResultDigest digest(*this);
  const std::vector<DamagedMission> damage =
      ed3r::store::FindDamage(database_, layout_, [&](const MissionCursor& mission) {
        digest.Add(mission.Checked(), mission.record(), mission.checksum());
        if (visit) visit(mission.Checked(), mission.record());
      });
  if (!damage.empty()) throw UserError(DamageText(database_.file(), damage.front()));
  return digest.Hex();
}

std::vector<DamagedMission> ResultReader::FindDamage() {
  const Transaction moment(database_, Transaction::Kind::kRead);
  CheckPlan();
  return ed3r::store::FindDamage(database_, layout_);
}

}  // namespace ed3r::store
