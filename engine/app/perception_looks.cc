#include "engine/app/perception_looks.h"

#include <fmt/format.h>

#include <iterator>

#include "engine/agents/decisions.h"
#include "engine/app/stored_run.h"
#include "engine/core/check.h"
#include "engine/perception/view.h"
#include "engine/sweep/plan_text.h"

namespace ed3r::app {
namespace {

// As the mission saw them: from where it stood after the move of each timestep.
void AddMission(const store::StoredMission& mission, const world::Scene& scene, const Config& config,
                std::uint64_t seed, std::vector<perception_fit::PeriodLook>& looks) {
  if (mission.record.site < 0 || mission.record.site >= std::ssize(scene.Sites()))
    throw UserError(fmt::format("mission {}: the store is damaged (fire site {} of {})", mission.id.mission,
                                mission.record.site, scene.Sites().size()));
  const perception::FireView fire(scene, static_cast<int>(mission.record.site));
  const std::vector<perception::Distractor> distractors = perception::DrawDistractors(
      scene, config.perception, seed, static_cast<std::uint32_t>(mission.record.scenario));
  for (const mission::TimestepRecord& step : mission.record.steps) {
    const perception::View view = fire.Look({{step.x_m, step.y_m, step.z_m}, step.yaw_rad, step.tilt_rad},
                                            config.sensing, config.perception, distractors);
    looks.push_back({.quantized = step.execution == static_cast<std::int64_t>(agents::Execution::kQuantized),
                     .tilt_rad = step.tilt_rad,
                     .fire_share = view.fire_share,
                     .smoke_share = view.smoke_share,
                     .distractor_share = view.distractor_share,
                     .mean = step.confidence_mean,
                     .deviation = step.confidence_sd,
                     .fire_in_view_pixels = step.fire_in_view != 0,
                     .fire_in_view_geometry = view.fire_in_view,
                     .held_out = mission.id.mission % 2 == 1});
  }
}

// What decides how a camera sees, and what the profile that is fitted stands on.
bool IsOfLooking(const std::string& key) {
  return key.starts_with("perception.") || key.starts_with("sensing.camera_") || key == "sensing.period_s";
}

// One profile is of one way to look: a mixture of several is none of them.
void CheckLooksAlike(const std::string& dir, const std::string& plan_text) {
  const sweep::WrittenPlan plan = sweep::ReadPlanText(plan_text);
  const sweep::WrittenPlan::Arm* first = nullptr;
  for (const sweep::WrittenPlan::Stage& stage : plan.stages)
    for (const sweep::WrittenPlan::Arm& arm : stage.arms) {
      const auto tier = arm.settings.find("perception.tier");
      if (stage.kind != sweep::StageKind::kFly || tier == arm.settings.end() || tier->second != "pixels")
        continue;
      if (first == nullptr) first = &arm;
      for (const auto& [key, value] : arm.settings)
        if (const auto other = first->settings.find(key);
            IsOfLooking(key) && (other == first->settings.end() || other->second != value))
          throw UserError(
              fmt::format("{}: arms {} and {} do not look alike ({} is {} and {}), and a profile is of one "
                          "way to look; fly "
                          "those that do as a run of their own",
                          dir, first->name, arm.name, key,
                          other == first->settings.end() ? "unknown" : other->second, value));
    }
}

}  // namespace

PerceptionLooks LooksOfRun(const std::string& dir) {
  StoredRun run(dir, "");
  CheckLooksAlike(dir, run.Reader().StoredRecipe().plan_text);
  const sweep::SweepPlan& plan = run.Plan();
  PerceptionLooks found;
  for (int s = 0; s < static_cast<int>(plan.stages.size()); ++s) {
    const sweep::Stage& stage = plan.stages[static_cast<std::size_t>(s)];
    for (int a = 0; a < static_cast<int>(stage.arms.size()); ++a) {
      const Config& config = stage.arms[static_cast<std::size_t>(a)].config;
      if (stage.kind != sweep::StageKind::kFly || config.perception.tier != PerceptionTier::kPixels) continue;
      if (found.looks.empty()) found.configured = config.perception;
      const world::Scene& scene = run.SharedInputs().SceneOf(config);
      run.Reader().NeedTimesteps(s);
      run.Reader().ForEachMission(s, a, store::Steps::kLoad, [&](const store::StoredMission& mission) {
        AddMission(mission, scene, config, plan.seed, found.looks);
      });
    }
  }
  if (found.looks.empty())
    throw UserError(
        fmt::format("{}: no mission of this run looked at pixels (perception.tier: pixels)", dir));
  return found;
}

}  // namespace ed3r::app
