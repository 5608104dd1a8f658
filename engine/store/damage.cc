#include "engine/store/damage.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/check.h"
#include "engine/store/schema.h"

namespace ed3r::store {
namespace {

std::string Line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// Trees that share pages, an index that does not hold what its table does: SQLite follows them without a word. What it says
// of values in rows is left out: their checksums tell, and such missions can be flown again.
void CheckTrees(Connection& database) {
  Statement check(database, "PRAGMA integrity_check");
  while (check.Step()) {
    const std::string found = check.Text(0);
    if (found == "ok" || found.find(" value in ") != std::string::npos) continue;
    database.CheckRead();
    const bool index_alone = found.find(kMissionsIndex) != std::string::npos;
    throw UserError(fmt::format(
        "{}: the file is damaged: SQLite's own check says '{}'; {}", database.file(), Line(found),
        index_alone ? "its results are whole: 'sqlite3 results.sqlite REINDEX' makes that index again"
                    : "it cannot be repaired: fly it again into another --out"));
  }
}

void AddLonelyTimesteps(Connection& database, const RunLayout& layout, std::vector<DamagedMission>& found) {
  Statement select(
      database,
      "SELECT DISTINCT run, mission FROM timesteps WHERE NOT EXISTS (SELECT 1 FROM missions WHERE "
      "missions.run = timesteps.run AND missions.mission = timesteps.mission)");
  while (select.Step())
    found.push_back({select.Int(0), select.Int(1), layout.DescribeKeys(select.Int(0), select.Int(1)),
                     "there are timesteps of it, but no record"});
}

void AddStrayTimings(Connection& database, const RunLayout& layout, std::vector<DamagedMission>& found) {
  Statement select(database, "SELECT run, mission FROM timings");
  while (select.Step())
    if (!layout.Place(select.Int(0), select.Int(1)))
      found.push_back({select.Int(0), select.Int(1), layout.DescribeKeys(select.Int(0), select.Int(1)),
                       "there is a time that it took, but the plan has no such mission"});
}

void AddStrayFailures(Connection& database, const RunLayout& layout, std::vector<DamagedMission>& found) {
  Statement select(
      database,
      "SELECT run, mission, EXISTS (SELECT 1 FROM missions WHERE missions.run = failures.run AND "
      "missions.mission = failures.mission) FROM failures");
  while (select.Step()) {
    const char* const what = !layout.Place(select.Int(0), select.Int(1))
                                 ? "it is said to have failed, but the plan has no such mission"
                             : select.Int(2) != 0 ? "it is said to have failed, and its record is stored"
                                                  : nullptr;
    if (what != nullptr)
      found.push_back(
          {select.Int(0), select.Int(1), layout.DescribeKeys(select.Int(0), select.Int(1)), what});
  }
}

}  // namespace

std::vector<DamagedMission> FindDamage(Connection& database, const RunLayout& layout,
                                       const std::function<void(const MissionCursor&)>& on_whole) {
  CheckTrees(database);
  std::vector<DamagedMission> found;
  MissionCursor cursor(database, layout, "", Steps::kLoad);
  while (cursor.Next())
    if (cursor.Damaged())
      found.push_back(cursor.damage());
    else if (on_whole)
      on_whole(cursor);
  AddLonelyTimesteps(database, layout, found);
  AddStrayTimings(database, layout, found);
  AddStrayFailures(database, layout, found);
  return found;
}

void RemoveMissions(Connection& database, const std::vector<DamagedMission>& missions) {
  for (const char* table : {"missions", "timesteps", "timings", "failures"}) {
    Statement remove(database, fmt::format("DELETE FROM {} WHERE run = ? AND mission = ?", table));
    for (const DamagedMission& mission : missions) remove.Run(mission.run, mission.mission);
  }
}

}  // namespace ed3r::store
