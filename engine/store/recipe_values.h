// The table 'recipe': a text by its key. schema.h seals it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/store/sqlite.h"

namespace ed3r::store {

std::optional<std::string> RecipeValue(Connection& database, std::string_view key);

// In place of the one that is there. Call it in a transaction that seals the recipe afterwards.
void PutRecipeValue(Connection& database, std::string_view key, std::string_view value);

}  // namespace ed3r::store
