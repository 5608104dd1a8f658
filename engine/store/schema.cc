#include "engine/store/schema.h"

#include <fmt/format.h>

#include <vector>

#include "engine/core/check.h"
#include "engine/mission/record.h"
#include "engine/store/columns.h"

namespace ed3r {
namespace {

constexpr std::int64_t kApplicationId = 0x45443352;  // "ED3R"

std::string TableDefinitions() {
  return fmt::format(R"(
CREATE TABLE recipe (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE worlds (file TEXT PRIMARY KEY, fingerprint TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE stages (stage INTEGER PRIMARY KEY, name TEXT NOT NULL, missions INTEGER NOT NULL);
CREATE TABLE runs (run INTEGER PRIMARY KEY, stage INTEGER NOT NULL, arm INTEGER NOT NULL, name TEXT NOT NULL,
  first_scenario INTEGER NOT NULL);
CREATE TABLE sessions (session INTEGER PRIMARY KEY, host TEXT NOT NULL, process INTEGER NOT NULL,
  begun_utc TEXT NOT NULL, ended_utc TEXT);
CREATE TABLE session_notes (session INTEGER, key TEXT, value TEXT NOT NULL, PRIMARY KEY (session, key))
  WITHOUT ROWID;
CREATE TABLE failures (run INTEGER, mission INTEGER, scenario INTEGER NOT NULL, seed INTEGER NOT NULL,
  message TEXT NOT NULL, PRIMARY KEY (run, mission)) WITHOUT ROWID;
CREATE TABLE timings (run INTEGER, mission INTEGER, session INTEGER NOT NULL, wall_s REAL NOT NULL,
  PRIMARY KEY (run, mission)) WITHOUT ROWID;
CREATE TABLE missions (run INTEGER, mission INTEGER, {}, PRIMARY KEY (run, mission)) WITHOUT ROWID;
CREATE TABLE timesteps (run INTEGER, mission INTEGER, {}, PRIMARY KEY (run, mission, k)) WITHOUT ROWID;
)",
                     ColumnDefinitions<MissionRecord>(), ColumnDefinitions<TimestepRecord>());
}

void CheckColumns(Connection& database, const std::string& table, const std::string& wanted) {
  Statement info(database, fmt::format("SELECT name FROM pragma_table_info('{}') LIMIT -1 OFFSET 2", table));
  std::string names;  // after the keys run and mission
  while (info.Step()) names += (names.empty() ? "" : ", ") + info.Text(0);
  if (names == wanted) return;
  throw UserError(
      fmt::format("{}: written by another version of ed3r (code {}): the columns of its table {} differ",
                  database.file(), ReadRecipe(database).code_version, table));
}

}  // namespace

FileKind CheckFile(Connection& database) {
  const std::int64_t application = database.Int("PRAGMA application_id");
  const std::int64_t version = database.Int("PRAGMA user_version");
  if (application == 0 && database.Int("SELECT count(*) FROM sqlite_schema") == 0) return FileKind::kEmpty;
  if (application != kApplicationId)
    throw UserError(fmt::format("{}: an SQLite file, but not one of ed3r", database.file()));
  if (version > kSchemaVersion)
    throw UserError(fmt::format("{}: written by a newer ed3r (schema {}, this one knows {})", database.file(),
                                version, kSchemaVersion));
  if (version < kSchemaVersion)
    throw UserError(fmt::format("{}: written by an older ed3r (schema {}, this one needs {})",
                                database.file(), version, kSchemaVersion));
  CheckColumns(database, "missions", ColumnNames<MissionRecord>());
  CheckColumns(database, "timesteps", ColumnNames<TimestepRecord>());
  return FileKind::kStore;
}

void CreateTables(Connection& database, const Recipe& recipe, const RunLayout& layout) {
  database.Execute(TableDefinitions());
  Statement put(database, "INSERT INTO recipe VALUES (?, ?)");
  put.Run("sweep", layout.name);
  put.Run("seed", std::to_string(layout.seed));
  put.Run("plan", recipe.plan_text);
  put.Run("code_version", recipe.code_version);
  Statement put_input(database, "INSERT INTO worlds VALUES (?, ?)");
  for (const auto& [file, fingerprint] : recipe.inputs) put_input.Run(file, fingerprint);
  Statement put_stage(database, "INSERT INTO stages VALUES (?, ?, ?)");
  Statement put_run(database, "INSERT INTO runs VALUES (?, ?, ?, ?, ?)");
  std::int64_t run = 0;
  for (std::size_t s = 0; s < layout.stages.size(); ++s) {
    const RunLayout::Stage& stage = layout.stages[s];
    const auto number = static_cast<std::int64_t>(s);
    put_stage.Run(number, stage.name, stage.missions);
    for (std::size_t a = 0; a < stage.arms.size(); ++a)
      put_run.Run(run++, number, static_cast<std::int64_t>(a), stage.arms[a].name,
                  stage.arms[a].first_scenario);
  }
  database.Execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId, kSchemaVersion));
}

Recipe ReadRecipe(Connection& database) {
  Recipe recipe;
  recipe.plan_text = database.Text("SELECT value FROM recipe WHERE key = 'plan'");
  recipe.code_version = database.Text("SELECT value FROM recipe WHERE key = 'code_version'");
  Statement inputs(database, "SELECT file, fingerprint FROM worlds");
  while (inputs.Step()) recipe.inputs[inputs.Text(0)] = inputs.Text(1);
  return recipe;
}

RunLayout ReadLayout(Connection& database) {
  RunLayout layout;
  layout.name = database.Text("SELECT value FROM recipe WHERE key = 'sweep'");
  layout.seed = std::stoull(database.Text("SELECT value FROM recipe WHERE key = 'seed'"));
  Statement stages(database, "SELECT name, missions FROM stages ORDER BY stage");
  while (stages.Step()) layout.stages.push_back({stages.Text(0), stages.Int(1), {}});
  Statement runs(database, "SELECT stage, name, first_scenario FROM runs ORDER BY run");
  while (runs.Step())
    layout.stages.at(static_cast<std::size_t>(runs.Int(0))).arms.push_back({runs.Text(1), runs.Int(2)});
  return layout;
}

std::vector<RunId> ReadStored(Connection& database) {
  Statement select(database,
                   "SELECT stage, arm, mission FROM missions JOIN runs USING (run) ORDER BY run, mission");
  std::vector<RunId> stored;
  while (select.Step())
    stored.push_back(
        {static_cast<int>(select.Int(0)), static_cast<int>(select.Int(1)), static_cast<int>(select.Int(2))});
  return stored;
}

}  // namespace ed3r
