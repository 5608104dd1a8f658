// The recipes that a file's missions have been flown by: a run may grow, and be continued by other code on purpose, and its
// missions stay what they were. Each recipe is known by a hash of its plan, inputs and code. Within a transaction of the
// caller's, who seals the recipe afterwards.
#pragma once

#include <string>
#include <vector>

#include "engine/store/recipe.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// False in files that were begun before missions had seals (checksums.h).
bool HasSeals(Connection& database);

// In the order in which they came, the present one last; none in files of before.
std::vector<std::string> ReadOrigins(Connection& database);
void WriteOrigins(Connection& database, const std::vector<std::string>& origins);

// The same with this recipe as the present one.
std::vector<std::string> WithOrigin(std::vector<std::string> origins, const Recipe& recipe);

}  // namespace ed3r::store
