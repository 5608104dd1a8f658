#include "engine/store/origins.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "engine/core/sha256.h"
#include "engine/store/columns.h"

namespace ed3r::store {
namespace {

constexpr char kKey[] = "origins";  // in the table recipe

std::string OriginOf(const Recipe& recipe) {
  std::string bytes;
  AppendText(bytes, recipe.plan_text);
  for (const auto& [name, fingerprint] : recipe.inputs) AppendText(bytes, name + '=' + fingerprint);
  AppendText(bytes, CodeText(recipe.code));
  Sha256 sha;
  sha.Update(bytes);
  return sha.Hex();
}

}  // namespace

bool HasSeals(Connection& database) {
  return database.Int("SELECT count(*) FROM pragma_table_info('missions') WHERE name = 'seal'") > 0;
}

std::vector<std::string> ReadOrigins(Connection& database) {
  Statement select(database, "SELECT value FROM recipe WHERE key = ?");
  select.Bind(0, kKey);
  std::vector<std::string> origins;
  if (!select.Step()) return origins;
  std::istringstream words(select.Text(0));
  for (std::string word; words >> word;) origins.push_back(word);
  return origins;
}

void WriteOrigins(Connection& database, const std::vector<std::string>& origins) {
  Statement put(database, "INSERT OR REPLACE INTO recipe VALUES (?, ?)");
  put.Run(kKey, fmt::format("{}", fmt::join(origins, " ")));
}

std::vector<std::string> WithOrigin(std::vector<std::string> origins, const Recipe& recipe) {
  const std::string origin = OriginOf(recipe);
  std::erase(origins, origin);
  origins.push_back(origin);
  return origins;
}

}  // namespace ed3r::store
