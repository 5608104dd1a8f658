#include "engine/schedule/inputs.h"

#include <fmt/format.h>

#include "engine/agents/strategy.h"
#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/mission/scenario.h"
#include "engine/robot/airframe.h"
#include "engine/schedule/training_stage.h"

namespace ed3r {
namespace {

void CheckArm(const Arm& arm, const Scene& scene, std::uint64_t seed) {
  FindStrategy(arm.config.mission.strategy);
  DealScenario(scene, arm.config.mission, seed, 0);
  CheckFlyable(arm.config);
}

// Arms that look at the same scene with the same detectors share them.
std::string PixelKey(const Config& config) {
  Config detector;
  detector.perception.detector = config.perception.detector;
  return config.mission.world + "\n" + CanonicalText(detector);
}

}  // namespace

Inputs::Inputs(const SweepPlan& plan) {
  CheckTraining(plan);
  for (const Stage& stage : plan.stages) {
    for (const Arm& arm : stage.arms) {
      std::shared_ptr<const Scene>& scene = scenes_[arm.config.mission.world];
      if (!scene) scene = Scene::Load(arm.config.mission.world);
      try {
        CheckArm(arm, *scene, plan.seed);
        AddPixels(arm.config);
      } catch (const UserError& error) {
        throw UserError(fmt::format("{}: arm {}: {}", plan.file, arm.name, error.what()));
      }
    }
  }
}

void Inputs::AddPixels(const Config& config) {
  if (config.perception.tier != PerceptionTier::kPixels) return;
  PixelTier& tier = pixels_[PixelKey(config)];
  if (tier.scene) return;
  tier.detectors = LoadDetectors(config.perception.detector);
  tier.scene = std::make_shared<const TraceScene>(SceneOf(config));
}

const Scene& Inputs::SceneOf(const Config& config) const { return *scenes_.at(config.mission.world); }

const PixelTier* Inputs::PixelsOf(const Config& config) const {
  return config.perception.tier == PerceptionTier::kPixels ? &pixels_.at(PixelKey(config)) : nullptr;
}

std::map<std::string, std::string> Inputs::Fingerprints(const SweepPlan& plan) const {
  std::map<std::string, std::string> fingerprints;
  for (const Stage& stage : plan.stages) {
    for (const Arm& arm : stage.arms) {
      const Config named = arm.CanonicalConfig();
      fingerprints[named.mission.world] = SceneOf(arm.config).Fingerprint();
      if (const PixelTier* pixels = PixelsOf(arm.config)) {
        const DetectorConfig& detector = named.perception.detector;
        fingerprints[fmt::format("detectors {}, {}", detector.full, detector.quantized)] =
            pixels->detectors.fingerprint;
      }
    }
  }
  return fingerprints;
}

}  // namespace ed3r
