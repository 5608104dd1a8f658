#include "engine/store/schema.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <vector>

#include "engine/core/check.h"
#include "engine/mission/record.h"
#include "engine/store/checksums.h"
#include "engine/store/columns.h"
#include "engine/store/recipe_values.h"
#include "engine/store/records.h"
#include "engine/store/seals.h"
#include "engine/store/shape.h"
#include "engine/store/views.h"

namespace ed3r::store {
namespace {

constexpr std::int64_t kApplicationId = 0x45443352;   // "ED3R"
constexpr char kUsesKey[] = "networks";               // in the recipe: a checksum over flown_networks
constexpr char kNetworkFilesKey[] = "network_files";  // and one over networks

std::string TableDefinitions() {
  return fmt::format(R"(
CREATE TABLE recipe (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE code (subsystem TEXT, identity TEXT, PRIMARY KEY (subsystem, identity)) STRICT, WITHOUT ROWID;
CREATE TABLE inputs (name TEXT PRIMARY KEY, fingerprint TEXT NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE places (called TEXT PRIMARY KEY, file TEXT NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE files (name TEXT PRIMARY KEY, sha256 TEXT NOT NULL, content BLOB) STRICT;
CREATE TABLE stages (stage INTEGER PRIMARY KEY, name TEXT NOT NULL, missions INTEGER NOT NULL) STRICT;
CREATE TABLE runs (run INTEGER PRIMARY KEY, stage INTEGER NOT NULL, arm INTEGER NOT NULL, name TEXT NOT NULL,
  first_scenario INTEGER NOT NULL) STRICT;
CREATE TABLE networks (sha256 TEXT PRIMARY KEY, name TEXT NOT NULL, model BLOB NOT NULL,
  checksum TEXT NOT NULL) STRICT;
CREATE TABLE flown_networks (run INTEGER, seed INTEGER, agent TEXT, sha256 TEXT NOT NULL,
  PRIMARY KEY (run, seed, agent)) STRICT, WITHOUT ROWID;
CREATE TABLE sessions (session INTEGER PRIMARY KEY, host TEXT NOT NULL, process INTEGER NOT NULL,
  begun_utc TEXT NOT NULL, ended_utc TEXT) STRICT;
CREATE TABLE session_notes (session INTEGER, key TEXT, value TEXT NOT NULL, PRIMARY KEY (session, key))
  STRICT, WITHOUT ROWID;
CREATE TABLE failures (run INTEGER, mission INTEGER, scenario INTEGER NOT NULL, seed INTEGER NOT NULL,
  message TEXT NOT NULL, kind TEXT NOT NULL DEFAULT '', PRIMARY KEY (run, mission)) STRICT, WITHOUT ROWID;
CREATE TABLE timings (run INTEGER, mission INTEGER, session INTEGER NOT NULL, wall_s REAL NOT NULL,
  PRIMARY KEY (run, mission)) STRICT, WITHOUT ROWID;
CREATE TABLE missions (run INTEGER, mission INTEGER, checksum TEXT NOT NULL, steps_checksum TEXT NOT NULL,
  seal TEXT NOT NULL, {},
  PRIMARY KEY (run, mission)) STRICT, WITHOUT ROWID;
CREATE TABLE timesteps (run INTEGER, mission INTEGER, {}, PRIMARY KEY (run, mission, k)) STRICT, WITHOUT ROWID;
)",
                     ColumnDefinitions<mission::MissionRecord>(),
                     ColumnDefinitions<mission::TimestepRecord>());
}

// Over everything that says what the missions are missions of: the name of each table, then its rows as texts.
std::string RecipeChecksum(Connection& database) {
  struct Part {
    const char *table, *rows;
  };
  constexpr Part kParts[] = {{"recipe", "key, value FROM recipe WHERE key != 'checksum' ORDER BY key"},
                             {"code", "subsystem, identity FROM code ORDER BY subsystem, identity"},
                             {"inputs", "name, fingerprint FROM inputs ORDER BY name"},
                             {"places", "called, file FROM places ORDER BY called"},
                             {"files", "name, sha256 FROM files ORDER BY name"},
                             {"stages", "stage, name, missions FROM stages ORDER BY stage"},
                             {"runs", "run, stage, arm, name, first_scenario FROM runs ORDER BY run"}};
  std::string bytes;
  for (const auto& [table, query] : kParts) {
    AppendText(bytes, table);
    Statement rows(database, fmt::format("SELECT {}", query));
    while (rows.Step())
      for (int column = 0; column < rows.Columns(); ++column) AppendText(bytes, rows.Text(column));
  }
  return HashOf(bytes);
}

void SealRecipe(Connection& database) { PutRecipeValue(database, "checksum", RecipeChecksum(database)); }

std::string HashOfRows(Connection& database, const char* query) {
  std::string bytes;
  Statement rows(database, query);
  while (rows.Step())
    for (int column = 0; column < rows.Columns(); ++column) AppendText(bytes, rows.Text(column));
  return HashOf(bytes);
}

// Over which arm asks which network. The networks themselves have checksums of their own.
std::string UsesChecksum(Connection& database) {
  return HashOfRows(database,
                    "SELECT run, seed, agent, sha256 FROM flown_networks ORDER BY run, seed, agent");
}

// Over the networks by what they compute, their names and the checksums of their files.
std::string NetworkFilesChecksum(Connection& database) {
  return HashOfRows(database, "SELECT sha256, name, checksum FROM networks ORDER BY sha256");
}

[[noreturn]] void FailDamagedRecipe(const Connection& database, std::string_view what) {
  throw UserError(
      fmt::format("{}: the file is damaged: {}; it cannot be repaired: fly it again into another --out",
                  database.file(), what));
}

std::string NeededRecipeValue(Connection& database, std::string_view key) {
  const std::optional<std::string> value = RecipeValue(database, key);
  if (!value) FailDamagedRecipe(database, fmt::format("its recipe has no {}", key));
  return *value;
}

// What a writer changes meanwhile is seen whole or not at all.
void CheckSeals(Connection& database) {
  const Transaction moment(database, Transaction::Kind::kRead);
  if (RecipeChecksum(database) != RecipeValue(database, "checksum"))
    FailDamagedRecipe(database, "its plan, layout or inputs do not match their checksum");
  if (!ReadOrigins(database).empty() && !HasSeals(database))
    FailDamagedRecipe(database, "its missions have lost their seals");
  const std::optional<std::string> uses = RecipeValue(database, kUsesKey);  // none in files of before
  if (uses && *uses != UsesChecksum(database))
    FailDamagedRecipe(database, "which arm flew which network does not match its checksum");
}

}  // namespace

FileKind CheckFile(Connection& database, FileUse use) {
  const std::int64_t application = database.Int("PRAGMA application_id");
  const std::int64_t version = database.Int("PRAGMA user_version");
  if (application == 0 && database.Int("SELECT count(*) FROM sqlite_schema") == 0) return FileKind::kEmpty;
  if (application != kApplicationId)
    throw UserError(fmt::format("{}: an SQLite file, but not one of ed3r", database.file()));
  if (version > kSchemaVersion)
    throw UserError(fmt::format("{}: written by a newer ed3r (format {}, this one knows {})", database.file(),
                                version, kSchemaVersion));
  if (version < 1)
    throw UserError(fmt::format("{}: written by an older ed3r (format {}, this one reads 1 and up)",
                                database.file(), version));
  CheckShape(database, static_cast<int>(version));
  if (use == FileUse::kWrite) CheckIndexes(database);
  const RecordTables tables(database);
  if (version >= kChecksumsSince) CheckSeals(database);
  if (use == FileUse::kWrite && (version < kSchemaVersion || !tables.complete()))
    throw UserError(
        fmt::format("{}: written by an older ed3r (code {}): it can be read, but not continued; give "
                    "another --out",
                    database.file(), CodeText(ReadRecipe(database).code)));
  return FileKind::kStore;
}

namespace {

// Adds what the file does not know of it yet.
void AddSession(Connection& database, const Recipe& recipe, const std::vector<std::string>& origins) {
  Statement put(database, "INSERT OR IGNORE INTO code (subsystem, identity) VALUES (?, ?)");
  for (const auto& [subsystem, identities] : recipe.code)
    for (const std::string& identity : identities) put.Run(subsystem, identity);
  if (HasSeals(database)) WriteOrigins(database, WithOrigin(origins, recipe));
  PutViews(database);
  SealRecipe(database);
}

// Into tables that are empty.
void PutRecipe(Connection& database, const Recipe& recipe, const RunLayout& layout,
               const std::vector<std::string>& origins) {
  PutRecipeValue(database, "sweep", layout.name);
  PutRecipeValue(database, "seed", std::to_string(layout.seed));
  PutRecipeValue(database, "plan", recipe.plan_text);
  Statement put_input(database, "INSERT INTO inputs (name, fingerprint) VALUES (?, ?)");
  for (const auto& [name, fingerprint] : recipe.inputs) put_input.Run(name, fingerprint);
  Statement put_place(database, "INSERT INTO places (called, file) VALUES (?, ?)");
  for (const auto& [called, file] : recipe.places) put_place.Run(called, file);
  Statement put_file(database, "INSERT INTO files (name, sha256, content) VALUES (?, ?, ?)");
  for (const InputFile& file : recipe.files) {
    put_file.Bind(0, file.name);
    put_file.Bind(1, file.sha256);
    file.content ? put_file.BindBlob(2, *file.content) : put_file.BindNull(2);
    put_file.Run();
  }
  Statement put_stage(database, "INSERT INTO stages (stage, name, missions) VALUES (?, ?, ?)");
  Statement put_run(database,
                    "INSERT INTO runs (run, stage, arm, name, first_scenario) VALUES (?, ?, ?, ?, ?)");
  std::int64_t run = 0;
  for (std::size_t s = 0; s < layout.stages.size(); ++s) {
    const RunLayout::Stage& stage = layout.stages[s];
    const auto number = static_cast<std::int64_t>(s);
    put_stage.Run(number, stage.name, stage.missions);
    for (std::size_t a = 0; a < stage.arms.size(); ++a)
      put_run.Run(run++, number, static_cast<std::int64_t>(a), stage.arms[a].name,
                  stage.arms[a].first_scenario);
  }
  AddSession(database, recipe, origins);
}

}  // namespace

void CreateTables(Connection& database, const Recipe& recipe, const RunLayout& layout) {
  database.Execute(TableDefinitions());
  CreateMissionsIndex(database);
  PutRecipe(database, recipe, layout, {});
  database.Execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId, kSchemaVersion));
}

void WriteFirstPage(Connection& database) {
  database.Execute(fmt::format("PRAGMA application_id = {}", kApplicationId));
}

void ReplaceRecipe(Connection& database, const Recipe& recipe, const RunLayout& layout) {
  const std::vector<std::string> origins = ReadOrigins(database);
  const std::optional<std::string> network_files = RecipeValue(database, kNetworkFilesKey);
  database.Execute(
      "DELETE FROM recipe; DELETE FROM inputs; DELETE FROM places; DELETE FROM files; DELETE FROM stages; "
      "DELETE "
      "FROM runs");
  PutRecipe(database, recipe, layout, origins);
  // The networks are those of before: where they do not match their checksum, that is still to be seen.
  if (network_files) PutRecipeValue(database, kNetworkFilesKey, *network_files);
  SealUses(database);  // their arms have other numbers now
}

void AddFailureKind(Connection& database) {
  if (!HasFailureKind(database))
    database.Execute("ALTER TABLE failures ADD COLUMN kind TEXT NOT NULL DEFAULT ''");
}

void CreateMissionsIndex(Connection& database) {
  database.Execute(fmt::format("CREATE INDEX IF NOT EXISTS {} ON missions (run)", kMissionsIndex));
}

void ContinueRecipe(Connection& database, const Recipe& recipe) {
  AddSession(database, recipe, ReadOrigins(database));
}

void SealUses(Connection& database) {
  PutRecipeValue(database, kUsesKey, UsesChecksum(database));
  SealRecipe(database);
}

void SealNetworkFiles(Connection& database) {
  PutRecipeValue(database, kNetworkFilesKey, NetworkFilesChecksum(database));
  SealRecipe(database);
}

bool NetworkFilesMatch(Connection& database) {
  const std::optional<std::string> files =
      RecipeValue(database, kNetworkFilesKey);  // none in files of before
  return !files || *files == NetworkFilesChecksum(database);
}

Recipe ReadRecipe(Connection& database) {
  Recipe recipe;
  recipe.plan_text = NeededRecipeValue(database, "plan");
  if (database.Int("PRAGMA user_version") < 2) {
    recipe.code = {{"sources", {NeededRecipeValue(database, "code_version")}}};
    Statement inputs(database, "SELECT file, fingerprint FROM worlds");
    while (inputs.Step()) recipe.inputs[inputs.Text(0)] = inputs.Text(1);
    return recipe;
  }
  Statement code(database, "SELECT subsystem, identity FROM code");
  while (code.Step()) recipe.code[code.Text(0)].insert(code.Text(1));
  Statement inputs(database, "SELECT name, fingerprint FROM inputs");
  while (inputs.Step()) recipe.inputs[inputs.Text(0)] = inputs.Text(1);
  Statement places(database, "SELECT called, file FROM places");
  while (places.Step()) recipe.places[places.Text(0)] = places.Text(1);
  return recipe;
}

std::vector<InputFile> ReadFiles(Connection& database) {
  std::vector<InputFile> files;
  if (database.Int("PRAGMA user_version") < 2) return files;
  Statement select(database, "SELECT name, sha256, content FROM files ORDER BY name");
  while (select.Step()) {
    InputFile& file = files.emplace_back(InputFile{select.Text(0), select.Text(1), std::nullopt});
    if (select.IsNull(2)) continue;
    file.content = select.Blob(2);
    if (HashOf(*file.content) != file.sha256)
      FailDamagedRecipe(database, fmt::format("its copy of {} does not match its checksum", file.name));
  }
  return files;
}

// Stages and arms are counted from 0 without gaps, arms stage by stage: everything else indexes by them.
RunLayout ReadLayout(Connection& database) {
  constexpr std::int64_t kMaxMissions = 10'000'000;
  RunLayout layout;
  layout.name = NeededRecipeValue(database, "sweep");
  const std::string seed = NeededRecipeValue(database, "seed");
  const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), layout.seed);
  if (error != std::errc() || end != seed.data() + seed.size())
    FailDamagedRecipe(database, fmt::format("its seed is '{}'", seed));
  Statement stages(database, "SELECT name, missions, stage FROM stages ORDER BY stage");
  while (stages.Step()) {
    if (stages.Int(2) != std::ssize(layout.stages) || stages.Int(1) < 0 || stages.Int(1) > kMaxMissions)
      FailDamagedRecipe(database, fmt::format("its stage {} of {} missions", stages.Int(2), stages.Int(1)));
    layout.stages.push_back({stages.Text(0), stages.Int(1), {}});
  }
  Statement runs(database, "SELECT stage, name, first_scenario, arm, run FROM runs ORDER BY run");
  std::int64_t run = 0, last_stage = 0;
  while (runs.Step()) {
    const std::int64_t stage = runs.Int(0), first_scenario = runs.Int(2);
    const bool known = stage >= last_stage && stage < std::ssize(layout.stages);
    if (!known || runs.Int(4) != run++ || runs.Int(3) != std::ssize(layout.stages[stage].arms) ||
        first_scenario < 0 || first_scenario > std::numeric_limits<std::uint32_t>::max())
      FailDamagedRecipe(database, fmt::format("its arm {} of stage {}", runs.Int(3), stage));
    layout.stages[stage].arms.push_back({runs.Text(1), first_scenario});
    last_stage = stage;
  }
  return layout;
}

std::vector<sweep::RunId> ReadStored(Connection& database, const RunLayout& layout) {
  Statement select(database,
                   fmt::format("SELECT run, mission FROM missions {} ORDER BY run, mission", kAlongTheKey));
  std::vector<sweep::RunId> stored;
  while (select.Step()) {
    const std::optional<sweep::RunId> id = layout.Place(select.Int(0), select.Int(1));
    if (!id)
      throw UserError(DamageText(
          database.file(), {select.Int(0), select.Int(1), layout.DescribeKeys(select.Int(0), select.Int(1)),
                            "the plan has no such mission"}));
    stored.push_back(*id);
  }
  return stored;
}

}  // namespace ed3r::store
