#include "studies/metrics/arm.h"

#include <algorithm>
#include <numeric>

#include "engine/core/check.h"
#include "studies/paper/arms.h"

namespace ed3r::metrics {

KnownUnseen Split(const ArmData& arm, SplitBy by) {
  KnownUnseen split;
  for (ArmData* part : {&split.known, &split.unseen}) part->stage = arm.stage, part->name = arm.name;
  for (const mission::MissionRecord& mission : arm.missions) {
    const bool known = (by == SplitBy::kSite ? mission.site_known : mission.base_station_known) != 0;
    (known ? split.known : split.unseen).missions.push_back(mission);
  }
  return split;
}

ArmData LongestShare(const ArmData& arm, int percent) {
  ED3R_CHECK(0 <= percent && percent <= 100, "a share of the missions");
  std::vector<std::size_t> order(arm.missions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return arm.missions[a].duration_s > arm.missions[b].duration_s;
  });
  order.resize(SizeOfShare(arm.missions.size(), percent));
  std::sort(order.begin(), order.end());
  ArmData longest{.stage = arm.stage, .name = arm.name, .missions = {}};
  for (const std::size_t i : order) longest.missions.push_back(arm.missions[i]);
  return longest;
}

ArmData P85Group(const ArmData& arm) {
  ArmData group = LongestShare(arm, kP85Percent);
  group.name = paper::P85Name(arm.name);
  return group;
}

}  // namespace ed3r::metrics
