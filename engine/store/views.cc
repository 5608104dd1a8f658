#include "engine/store/views.h"

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/mission/record.h"
#include "engine/store/checksums.h"
#include "engine/store/columns.h"
#include "engine/store/recipe_values.h"
#include "engine/store/words.h"

namespace ed3r::store {
namespace {

template <class Record>
std::string Definition(std::string_view view, std::string_view table) {
  std::string columns;
  for (const Column& column : ColumnsOf<Record>()) {
    std::string value = fmt::format("{}.{}", table, column.name);
    if (const auto words = WordsOf(column.name); !words.empty()) {
      value = fmt::format("CASE {}", value);
      for (const auto& [code, word] : words) value += fmt::format(" WHEN {} THEN '{}'", code, word);
      value += " END";
    }
    columns += fmt::format(", {} AS {}", value, column.name);
  }
  return fmt::format(
      "CREATE VIEW {0} AS SELECT stages.name AS stage, runs.name AS arm, {1}.mission AS mission{2}\n"
      "  FROM {1} JOIN runs ON runs.run = {1}.run JOIN stages ON stages.stage = runs.stage",
      view, table, columns);
}

// By name. The text is what SQLite keeps of it.
std::vector<std::pair<std::string, std::string>> Views() {
  return {{"named_missions", Definition<mission::MissionRecord>("named_missions", "missions")},
          {"named_timesteps", Definition<mission::TimestepRecord>("named_timesteps", "timesteps")}};
}

// "" where no view has the name, which SQLite reads in any letters.
std::string TextOf(Connection& database, const std::string& view) {
  Statement select(database, "SELECT sql FROM sqlite_schema WHERE type = 'view' AND lower(name) = ?");
  select.Bind(0, view);
  return select.Step() ? select.Text(0) : "";
}

// Somebody's own table, such as one that was made of the view.
bool IsTable(Connection& database, const std::string& name) {
  Statement select(database, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND lower(name) = ?");
  select.Bind(0, name);
  return select.Step();
}

}  // namespace

void PutViews(Connection& database) {
  for (const auto& [name, definition] : Views()) {
    if (IsTable(database, name)) continue;
    if (TextOf(database, name) != definition)
      database.Execute(fmt::format("DROP VIEW IF EXISTS {}; {}", name, definition));
    PutRecipeValue(database, name, HashOf(definition));
  }
}

void CheckViews(Connection& database) {
  for (const auto& [name, definition] : Views()) {
    const std::optional<std::string> sealed = RecipeValue(database, name);
    const std::string text = TextOf(database, name);
    if (sealed && !text.empty() && *sealed != HashOf(text))
      throw UserError(fmt::format(
          "{}: the file is damaged: its view {} is not as it was made, and may tell another column "
          "or word; 'ed3r run SWEEP' makes it anew",
          database.file(), name));
  }
}

}  // namespace ed3r::store
