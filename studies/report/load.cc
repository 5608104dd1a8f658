#include "studies/report/load.h"

#include "engine/store/reader.h"

namespace ed3r {

RunResults LoadRun(const std::string& dir) {
  ResultReader reader(dir);
  RunResults results;
  results.name = reader.Layout().name;
  for (const ArmStatus& status : reader.Status()) {
    ArmData arm;
    arm.stage = status.stage;
    arm.name = status.arm;
    arm.failed = static_cast<int>(status.failed);
    arm.missing = static_cast<int>(status.missing);
    results.arms.push_back(std::move(arm));
  }
  reader.ForEachMission(Steps::kSkip, [&](const StoredMission& mission) {
    const std::int64_t run = reader.Layout().RunIndex(mission.id.stage, mission.id.arm);
    results.arms[static_cast<std::size_t>(run)].missions.push_back(mission.record);
  });
  return results;
}

}  // namespace ed3r
