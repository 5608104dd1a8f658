#include "engine/store/schema.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <iterator>
#include <limits>
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

namespace {

[[noreturn]] void Damaged(const Connection& database, const std::string& what) {
  throw UserError(fmt::format("{}: the file is damaged ({})", database.file(), what));
}

std::string RecipeValue(Connection& database, const char* key) {
  Statement select(database, "SELECT value FROM recipe WHERE key = ?");
  select.Bind(0, std::string_view(key));
  if (!select.Step()) Damaged(database, fmt::format("its recipe has no '{}'", key));
  return select.Text(0);
}

std::uint64_t Seed(Connection& database) {
  const std::string text = RecipeValue(database, "seed");
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size())
    Damaged(database, fmt::format("its seed is '{}'", text));
  return seed;
}

}  // namespace

Recipe ReadRecipe(Connection& database) {
  Recipe recipe;
  recipe.plan_text = RecipeValue(database, "plan");
  recipe.code_version = RecipeValue(database, "code_version");
  Statement inputs(database, "SELECT file, fingerprint FROM worlds");
  while (inputs.Step()) recipe.inputs[inputs.Text(0)] = inputs.Text(1);
  return recipe;
}

// Stages and arms are counted from 0 without gaps, arms stage by stage: everything else indexes by them.
RunLayout ReadLayout(Connection& database) {
  constexpr std::int64_t kMaxMissions = 10'000'000;
  RunLayout layout;
  layout.name = RecipeValue(database, "sweep");
  layout.seed = Seed(database);
  Statement stages(database, "SELECT name, missions, stage FROM stages ORDER BY stage");
  while (stages.Step()) {
    if (stages.Int(2) != std::ssize(layout.stages) || stages.Int(1) < 0 || stages.Int(1) > kMaxMissions)
      Damaged(database, fmt::format("its stage {} of {} missions", stages.Int(2), stages.Int(1)));
    layout.stages.push_back({stages.Text(0), stages.Int(1), {}});
  }
  Statement runs(database, "SELECT stage, name, first_scenario, arm, run FROM runs ORDER BY run");
  std::int64_t run = 0, last_stage = 0;
  while (runs.Step()) {
    const std::int64_t stage = runs.Int(0), first_scenario = runs.Int(2);
    const bool known = stage >= last_stage && stage < std::ssize(layout.stages);
    if (!known || runs.Int(4) != run++ || runs.Int(3) != std::ssize(layout.stages[stage].arms) ||
        first_scenario < 0 || first_scenario > std::numeric_limits<std::uint32_t>::max())
      Damaged(database, fmt::format("its arm {} of stage {}", runs.Int(3), stage));
    layout.stages[stage].arms.push_back({runs.Text(1), first_scenario});
    last_stage = stage;
  }
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
