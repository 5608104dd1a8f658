#include "engine/app/status_of_shards.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "engine/app/commands.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/json_text.h"
#include "engine/store/schema.h"
#include "engine/store/shards/shards.h"
#include "engine/store/sqlite.h"
#include "engine/store/tally.h"

namespace ed3r::app {
namespace {

// Comparing a record with its checksum takes microseconds.
constexpr std::int64_t kMostCompared = 100'000;
// A store that was not written for this long is not being flown into: the longest missions take less.
constexpr double kStill_s = 120.0;

struct Found {
  std::string name;
  std::size_t stores = 0, growing = 0;
  std::vector<store::ArmStatus> arms;
  std::map<std::string, std::string> unreadable;  // store -> why
  double missions_per_s = 0.0;

  std::int64_t Missing() const {
    std::int64_t missing = 0;
    for (const store::ArmStatus& arm : arms) missing += arm.missing;
    return missing;
  }
  // "" when nothing grows or nothing is missing.
  std::string ExpectedEnd() const {
    if (missions_per_s <= 0 || Missing() == 0) return "";
    const double left_s = static_cast<double>(Missing()) / missions_per_s;
    const std::time_t end = std::time(nullptr) + static_cast<std::time_t>(std::ceil(left_s));
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(end));
  }
};

Found Look(const std::string& dir) {
  std::vector<std::string> stores = store::ShardDirs(dir);
  if (store::HoldsResults(dir)) stores.insert(stores.begin(), dir);
  Found found;
  found.stores = stores.size();
  std::optional<store::Tally> tally;
  for (const std::string& store : stores) {
    try {
      if (!tally) {
        const store::ResultReader reader(store);
        found.name = reader.Layout().name;
        tally.emplace(reader.StoredRecipe(), reader.Layout());
      }
      tally->Add(store);
      const double pace = store::MissionsPerSecond(store, kStill_s);
      found.missions_per_s += pace;
      found.growing += pace > 0 ? 1 : 0;
    } catch (const UserError& error) {
      found.unreadable[store] = error.what();
    }
  }
  if (tally) found.arms = tally->Arms();
  return found;
}

void PrintJson(const Found& found) {
  nlohmann::ordered_json object = {{"name", found.name}, {"arms", ArmsJson(found.arms)}};
  object["stores"] = found.stores;
  object["growing"] = found.growing;
  object["expected_end_utc"] = nullptr;
  if (const std::string end = found.ExpectedEnd(); !end.empty()) object["expected_end_utc"] = end;
  object["unreadable"] = nlohmann::ordered_json::array();
  for (const auto& [store, why] : found.unreadable)
    object["unreadable"].push_back({{"store", store}, {"why", why}});
  fmt::print("{}\n", JsonText(object));
}

void PrintText(const Found& found) {
  fmt::print("{:<12} {:<28} {:>8} {:>8} {:>8} {:>8}\n", "stage", "arm", "planned", "done", "failed",
             "missing");
  for (const store::ArmStatus& arm : found.arms)
    fmt::print("{:<12} {:<28} {:>8} {:>8} {:>8} {:>8}\n", arm.stage, arm.arm, arm.planned, arm.done,
               arm.failed, arm.missing);
  fmt::print("{}, {} growing", Counted(static_cast<std::int64_t>(found.stores), "store"), found.growing);
  if (const std::string end = found.ExpectedEnd(); !end.empty()) fmt::print("; all done by about {}", end);
  fmt::print("\n");
  fmt::print(
      "counted, not compared with their checksums: 'ed3r verify' of a store does, and so does 'ed3r "
      "merge'\n");
  for (const auto& [store, why] : found.unreadable) fmt::print("not counted: {}\n", why);
}

}  // namespace

nlohmann::ordered_json ArmsJson(const std::vector<store::ArmStatus>& arms) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const store::ArmStatus& arm : arms)
    json.push_back({{"stage", arm.stage},
                    {"arm", arm.arm},
                    {"planned", arm.planned},
                    {"done", arm.done},
                    {"failed", arm.failed},
                    {"missing", arm.missing}});
  return json;
}

bool IsTallied(const std::string& dir) {
  if (!store::ShardDirs(dir).empty()) return true;
  if (!store::HoldsResults(dir)) return false;
  store::Connection database((std::filesystem::path(dir) / store::kResultsFile).string(),
                             store::Connection::Access::kReadOnly);
  return database.Int("SELECT count(*) FROM sqlite_schema WHERE name = 'timings'") > 0 &&
         database.Int(fmt::format("SELECT count(*) FROM (SELECT 1 FROM timings LIMIT {})",
                                  kMostCompared + 1)) > kMostCompared;
}

int TellTally(const std::string& dir, bool json) {
  const Found found = Look(dir);
  json ? PrintJson(found) : PrintText(found);
  return found.unreadable.empty() ? kDone : kFailedInside;
}

}  // namespace ed3r::app
