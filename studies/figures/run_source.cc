#include "studies/figures/run_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "engine/core/check.h"
#include "engine/store/restored_files.h"
#include "engine/sweep/arm_id.h"
#include "engine/sweep/plan_text.h"

namespace ed3r::figures {
namespace {

// Lower is tried first.
int Rank(const ArmPlan& plan) { return plan.warmup ? 2 : plan.name == "ed3r-75" ? 0 : 1; }

// The mission of the median duration among those that ended so; equally long ones in mission order.
std::optional<sweep::RunId> MedianMission(store::ResultReader& reader, int stage, int arm,
                                          mission::Outcome outcome) {
  std::vector<std::pair<double, int>> ended_so;
  reader.ForEachMission(stage, arm, store::Steps::kSkip, [&](const store::StoredMission& mission) {
    if (mission.keeps_timesteps && mission.record.outcome == static_cast<std::int64_t>(outcome))
      ended_so.emplace_back(mission.record.duration_s, mission.id.mission);
  });
  if (ended_so.empty()) return std::nullopt;
  std::sort(ended_so.begin(), ended_so.end());
  return sweep::RunId{stage, arm, ended_so[(ended_so.size() - 1) / 2].second};
}

// Indices of the flying arms of the layout, those that are tried first in front.
struct Candidate {
  int stage, arm;
  const ArmPlan* plan;
};

std::vector<Candidate> Candidates(const store::RunLayout& layout, std::span<const ArmPlan> plans) {
  std::vector<Candidate> candidates;
  for (int s = 0; s < static_cast<int>(layout.stages.size()); ++s)
    for (int a = 0; a < static_cast<int>(layout.stages[s].arms.size()); ++a)
      for (const ArmPlan& plan : plans)
        if (layout.stages[s].missions > 0 && plan.stage == layout.stages[s].name &&
            plan.name == layout.stages[s].arms[a].name)
          candidates.push_back({s, a, &plan});
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return Rank(*a.plan) < Rank(*b.plan); });
  return candidates;
}

}  // namespace

std::string ArmPlan::Setting(const std::string& key) const {
  const auto found = settings.find(key);
  return found == settings.end() ? "" : found->second;
}

std::vector<ArmPlan> ReadArmPlans(std::string_view plan_text) {
  const sweep::WrittenPlan written = sweep::ReadPlanText(plan_text);
  std::set<std::string> warmups;
  for (const sweep::WrittenPlan::Stage& stage : written.stages)
    if (stage.kind == sweep::StageKind::kTrain) warmups.insert(stage.after.begin(), stage.after.end());
  std::vector<ArmPlan> plans;
  for (const sweep::WrittenPlan::Stage& stage : written.stages)
    for (const sweep::WrittenPlan::Arm& arm : stage.arms)
      plans.push_back({.stage = stage.name,
                       .name = arm.name,
                       .warmup = warmups.contains(stage.name),
                       .settings = arm.settings,
                       .precision = stage.precision});
  return plans;
}

std::vector<ShownMission> PickMissions(store::ResultReader& reader, std::span<const ArmPlan> plans) {
  std::vector<ShownMission> shown;
  std::optional<std::string> world;
  for (const mission::Outcome outcome :
       {mission::Outcome::kSuccess, mission::Outcome::kFalsePositive, mission::Outcome::kBatteryDepleted})
    for (const Candidate& candidate : Candidates(reader.Layout(), plans)) {
      if (world && candidate.plan->Setting("mission.world") != *world) continue;
      const auto id = MedianMission(reader, candidate.stage, candidate.arm, outcome);
      if (!id) continue;
      shown.push_back(
          {candidate.plan->stage, candidate.plan->name, id->mission, reader.LoadMission(*id).record});
      world = candidate.plan->Setting("mission.world");
      break;
    }
  return shown;
}

FoundScene FindScene(store::ResultReader& reader, const std::string& world) {
  const auto& worlds = reader.StoredRecipe().inputs;
  const auto flown = worlds.find(world);
  if (flown == worlds.end()) return {nullptr, fmt::format("the recipe does not know the world '{}'", world)};
  try {
    const store::RestoredFiles files(reader);
    std::shared_ptr<const world::Scene> scene = world::Scene::Load(files.PathOf(world));
    if (scene->Fingerprint() != flown->second)
      return {nullptr, fmt::format("{} has changed since it was flown in", world)};
    return {scene, ""};
  } catch (const UserError& error) {
    return {nullptr, error.what()};
  }
}

RunSource ReadRunSource(store::ResultReader& reader, const std::string& variant) {
  const store::Transaction moment = reader.Moment();
  RunSource source;
  source.plans = ReadArmPlans(reader.StoredRecipe().plan_text);
  std::erase_if(source.plans,
                [&](const ArmPlan& plan) { return sweep::ArmId::Of(plan.name).variant != variant; });
  source.missions = PickMissions(reader, source.plans);
  for (const ArmPlan& plan : source.plans)
    if (!source.missions.empty() && plan.stage == source.missions.front().stage &&
        plan.name == source.missions.front().arm)
      source.scene = FindScene(reader, plan.Setting("mission.world"));
  for (ArmPlan& plan : source.plans) plan.name = sweep::ArmId::Of(plan.name).name;
  for (ShownMission& mission : source.missions) mission.arm = sweep::ArmId::Of(mission.arm).name;
  return source;
}

}  // namespace ed3r::figures
