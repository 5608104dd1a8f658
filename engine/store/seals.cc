#include "engine/store/seals.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "engine/core/check.h"
#include "engine/store/columns.h"
#include "engine/store/recipe_values.h"

namespace ed3r::store {
namespace {

constexpr char kKey[] = "origins";  // in the table recipe

std::string OriginOf(const Recipe& recipe) {
  std::string bytes;
  AppendText(bytes, recipe.plan_text);
  for (const auto& [name, fingerprint] : recipe.inputs) AppendText(bytes, name + '=' + fingerprint);
  AppendText(bytes, CodeText(recipe.code));
  return HashOf(bytes);
}

}  // namespace

bool HasSeals(Connection& database) {
  return database.Int("SELECT count(*) FROM pragma_table_info('missions') WHERE name = 'seal'") > 0;
}

std::vector<std::string> ReadOrigins(Connection& database) {
  std::vector<std::string> origins;
  std::istringstream words(RecipeValue(database, kKey).value_or(""));
  for (std::string word; words >> word;) origins.push_back(word);
  return origins;
}

void WriteOrigins(Connection& database, const std::vector<std::string>& origins) {
  PutRecipeValue(database, kKey, fmt::format("{}", fmt::join(origins, " ")));
}

std::vector<std::string> WithOrigin(std::vector<std::string> origins, const Recipe& recipe) {
  const std::string origin = OriginOf(recipe);
  std::erase(origins, origin);
  origins.push_back(origin);
  return origins;
}

Seals::Seals(Connection& database)
    : there_(HasSeals(database)),
      origins_(there_ ? ReadOrigins(database) : std::vector<std::string>()),
      select_networks_(database, there_
                                     ? "SELECT agent, sha256 FROM flown_networks WHERE run = ? AND seed = ? "
                                       "ORDER BY agent"
                                     : "SELECT '', '' WHERE ?1 = ?2 AND 0") {}

const std::string& Seals::NetworksOf(std::int64_t run, std::int64_t network) {
  static const std::string kNone;
  if (network < 0) return kNone;
  const auto known = networks_.find({run, network});
  if (known != networks_.end()) return known->second;
  std::string bytes;
  select_networks_.Bind(0, run);
  select_networks_.Bind(1, network);
  while (select_networks_.Step()) {
    AppendText(bytes, select_networks_.Text(0));
    AppendText(bytes, select_networks_.Text(1));
  }
  select_networks_.Reset();
  if (bytes.empty()) return kNone;  // not put yet
  return networks_[{run, network}] = bytes;
}

std::string Seals::Of(const std::string& mission_checksum, std::int64_t run, std::int64_t network) {
  ED3R_CHECK(!origins_.empty(), "a file whose recipe is not written yet");
  return HashOf(mission_checksum + origins_.back() + NetworksOf(run, network));
}

bool Seals::Fits(const std::string& mission_checksum, std::int64_t run, std::int64_t network,
                 const std::string& seal) {
  const std::string& networks = NetworksOf(run, network);
  return std::any_of(origins_.rbegin(), origins_.rend(), [&](const std::string& origin) {
    return HashOf(mission_checksum + origin + networks) == seal;
  });
}

}  // namespace ed3r::store
