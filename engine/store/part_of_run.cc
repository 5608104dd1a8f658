#include "engine/store/part_of_run.h"

#include <algorithm>
#include <utility>

#include "engine/store/growth.h"
#include "engine/store/reader.h"

namespace ed3r::store {
std::set<std::string> StagesWithNetworks(ResultReader& reader) {
  std::set<std::string> stages;
  for (const NetworkUse& use : reader.Networks().uses)
    stages.insert(reader.Layout().stages.at(static_cast<std::size_t>(use.stage)).name);
  return stages;
}

PartOfRun ComparePlans(const Recipe& run, const RunLayout& layout, ResultReader& part) {
  const Recipe& other = part.StoredRecipe();
  if (run.plan_text == other.plan_text) {
    if (auto difference = Difference(run, other)) return {PartPlan::kOther, *difference};
    if (!part.Layout().SameMissions(layout)) return {PartPlan::kOther, "its stages, arms or seed differ"};
    return {PartPlan::kSame, ""};
  }
  const std::set<std::string> learned = StagesWithNetworks(part);
  if (GrowthOf(other, run, learned).Allowed()) return {PartPlan::kEarlier, ""};
  Growth growth = GrowthOf(run, other, learned);
  if (growth.Allowed()) return {PartPlan::kGrown, std::move(growth.what)};
  return {PartPlan::kOther, std::move(growth.difference)};
}

PartOfRun FindPlan(const Recipe& run, const RunLayout& layout, ResultReader& part) {
  PartOfRun found = ComparePlans(run, layout, part);
  if (!found.Counts()) return found;
  if (auto difference = CodeDifference(run.code, part.StoredRecipe().code))
    return {PartPlan::kMixed, *difference};
  return found;
}

std::optional<sweep::RunId> SameMission(const RunLayout& from, const sweep::RunId& id, const RunLayout& to) {
  const RunLayout::Stage& stage = from.stages.at(static_cast<std::size_t>(id.stage));
  const std::string& name = stage.arms.at(static_cast<std::size_t>(id.arm)).name;
  for (std::size_t s = 0; s < to.stages.size(); ++s) {
    if (to.stages[s].name != stage.name) continue;
    const auto& arms = to.stages[s].arms;
    const auto arm = std::find_if(arms.begin(), arms.end(),
                                  [&](const RunLayout::Arm& candidate) { return candidate.name == name; });
    if (arm != arms.end())
      return sweep::RunId{static_cast<int>(s), static_cast<int>(arm - arms.begin()), id.mission};
  }
  return std::nullopt;
}

}  // namespace ed3r::store
