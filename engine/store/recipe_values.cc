#include "engine/store/recipe_values.h"

namespace ed3r::store {

std::optional<std::string> RecipeValue(Connection& database, std::string_view key) {
  Statement select(database, "SELECT value FROM recipe WHERE key = ?");
  select.Bind(0, key);
  if (!select.Step()) return std::nullopt;
  return select.Text(0);
}

void PutRecipeValue(Connection& database, std::string_view key, std::string_view value) {
  Statement(database, "INSERT OR REPLACE INTO recipe (key, value) VALUES (?, ?)").Run(key, value);
}

}  // namespace ed3r::store
