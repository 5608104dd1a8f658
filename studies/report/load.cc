#include "studies/report/load.h"

#include <algorithm>

#include "engine/store/reader.h"

namespace ed3r {
namespace {

std::vector<MissionRecord> LoadMissions(ResultReader& reader, int stage, int arm) {
  std::vector<MissionRecord> missions;
  reader.ForEachMission(stage, arm, Steps::kSkip,
                        [&](const StoredMission& mission) { missions.push_back(mission.record); });
  return missions;
}

}  // namespace

RunResults LoadRun(const std::string& dir) {
  ResultReader reader(dir);
  const RunLayout& layout = reader.Layout();
  RunResults results{layout.name, {}};
  const std::vector<ArmStatus> status = reader.Status();
  for (int s = 0; s < static_cast<int>(layout.stages.size()); ++s) {
    const RunLayout::Stage& stage = layout.stages[s];
    if (stage.missions == 0) continue;
    for (int a = 0; a < static_cast<int>(stage.arms.size()); ++a) {
      ArmData arm{stage.name, stage.arms[a].name, LoadMissions(reader, s, a)};
      const auto flown = static_cast<std::int64_t>(arm.missions.size());
      // Counted from the missions at hand: more may have come in since the status was read.
      arm.failed = static_cast<int>(std::min(status[layout.RunIndex(s, a)].failed, stage.missions - flown));
      arm.missing = static_cast<int>(stage.missions - flown - arm.failed);
      results.arms.push_back(std::move(arm));
    }
  }
  return results;
}

}  // namespace ed3r
