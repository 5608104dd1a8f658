#include "studies/metrics/arm.h"

namespace ed3r {

KnownUnseen Split(const ArmData& arm, SplitBy by) {
  KnownUnseen split;
  for (ArmData* part : {&split.known, &split.unseen}) part->stage = arm.stage, part->name = arm.name;
  for (const MissionRecord& mission : arm.missions) {
    const bool known = (by == SplitBy::kSite ? mission.site_known : mission.base_station_known) != 0;
    (known ? split.known : split.unseen).missions.push_back(mission);
  }
  return split;
}

}  // namespace ed3r
