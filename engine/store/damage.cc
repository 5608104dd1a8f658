#include "engine/store/damage.h"

#include <fmt/format.h>

namespace ed3r::store {
namespace {

void AddLonelyTimesteps(Connection& database, const RunLayout& layout, std::vector<DamagedMission>& found) {
  Statement select(
      database,
      "SELECT DISTINCT run, mission FROM timesteps WHERE NOT EXISTS (SELECT 1 FROM missions WHERE "
      "missions.run = timesteps.run AND missions.mission = timesteps.mission)");
  while (select.Step())
    found.push_back({select.Int(0), select.Int(1), layout.DescribeKeys(select.Int(0), select.Int(1)),
                     "there are timesteps of it, but no record"});
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
  std::vector<DamagedMission> found;
  MissionCursor cursor(database, layout, "", Steps::kLoad);
  while (cursor.Next())
    if (cursor.Damaged())
      found.push_back(cursor.damage());
    else if (on_whole)
      on_whole(cursor);
  AddLonelyTimesteps(database, layout, found);
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
