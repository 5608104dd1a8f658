#include "engine/app/expected_time.h"

#include "engine/agents/strategy.h"
#include "engine/robot/energy.h"

namespace ed3r::app {
namespace {

// Simulated over wall seconds per core of this engine on its reference machine (2 shared cores of an EPYC server with
// AVX2) in the two tiers of perception.
constexpr double kRealTimePerCore = 10000.0;
constexpr double kRealTimePerCoreOnPixels = 1100.0;
// Mean length of a mission that may end early (paper: RBS).
constexpr double kEarlyCompletionS = 280.0;

// A mission without early completion lasts until the battery is empty.
double ExpectedSimulatedS(const sweep::Arm& arm) {
  const Config& config = arm.config;
  if (agents::FindStrategy(config.mission.strategy).early_completion && config.agents.early_completion)
    return kEarlyCompletionS;
  return config.robot.BatteryJ() /
         robot::MovementPowerOf(config.robot, config.environment, config.energy).hover_w;
}

}  // namespace

double ExpectedCoreS(const sweep::Arm& arm) {
  const bool pixels = arm.config.perception.tier == PerceptionTier::kPixels;
  return ExpectedSimulatedS(arm) / (pixels ? kRealTimePerCoreOnPixels : kRealTimePerCore);
}

double ExpectedCoreS(const sweep::Stage& stage) {
  double core_s = 0.0;
  if (stage.kind == sweep::StageKind::kFly)
    for (const sweep::Arm& arm : stage.arms) core_s += stage.missions * ExpectedCoreS(arm);
  return core_s;
}

}  // namespace ed3r::app
