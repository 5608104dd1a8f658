#include "engine/app/expected_time.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "engine/agents/strategy.h"
#include "engine/robot/energy.h"
#include "engine/schedule/training_stage.h"

namespace ed3r::app {
namespace {

// Simulated over wall seconds per core in the two tiers of perception: what a shared server's core does at least
// (results/speed.md has what a free one does).
constexpr double kRealTimePerCore = 20000.0;
constexpr double kRealTimePerCoreOnPixels = 1100.0;
// Mean length of a mission that may end early (paper: RBS).
constexpr double kEarlyCompletionS = 280.0;

// Standard deviation over mean of missions' durations: those that may end early, and those until the battery is empty
// (results/scale.md, sweeps/default_world.yaml).
constexpr double kEarlyCompletionSpread = 1.29;
constexpr double kDepletionSpread = 0.03;

// Timesteps of a warm-up mission (paper), and seconds that a sample takes in an epoch (paper.yaml: 115 thousand samples,
// 2000 epochs, seven networks in 15 core minutes).
constexpr double kWarmupTimesteps = 56.4;
constexpr double kSampleS = 0.55e-6;

bool MayEndEarly(const sweep::Arm& arm) {
  return agents::FindStrategy(arm.config.mission.strategy).early_completion &&
         arm.config.agents.early_completion;
}

// A mission without early completion lasts until the battery is empty.
double ExpectedSimulatedS(const sweep::Arm& arm) {
  const Config& config = arm.config;
  if (MayEndEarly(arm)) return kEarlyCompletionS;
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

ExpectedTraining ExpectedTrainingOf(const sweep::SweepPlan& plan) {
  const auto trains = [](const sweep::Stage& stage) { return stage.kind == sweep::StageKind::kTrain; };
  if (std::count_if(plan.stages.begin(), plan.stages.end(), trains) != 1) return {};
  const sweep::Stage& training = *std::find_if(plan.stages.begin(), plan.stages.end(), trains);
  double missions = 0.0, epochs = 0.0, sharing = 1.0;
  for (const sweep::Stage& stage : plan.stages) {
    if (std::find(training.after.begin(), training.after.end(), stage.name) != training.after.end())
      missions += static_cast<double>(stage.missions);
    if (std::find(stage.after.begin(), stage.after.end(), training.name) == stage.after.end()) continue;
    for (const sweep::Arm& arm : stage.arms) {
      const TrainingConfig& config = arm.config.training;
      epochs = std::max(epochs, static_cast<double>(config.epochs));
      if (config.own_warmups) sharing = std::max(sharing, static_cast<double>(config.seeds));
    }
  }
  return {schedule::CountNetworks(plan), missions / sharing * kWarmupTimesteps * epochs * kSampleS};
}

ExpectedShards ExpectedShardsOf(const sweep::Stage& stage, std::int64_t shards) {
  double variance_core_s2 = 0.0;
  for (const sweep::Arm& arm : stage.arms)
    variance_core_s2 +=
        stage.missions *
        std::pow(ExpectedCoreS(arm) * (MayEndEarly(arm) ? kEarlyCompletionSpread : kDepletionSpread), 2);
  const auto missions = static_cast<std::int64_t>(stage.arms.size()) * stage.missions;
  ExpectedShards expected;
  expected.tasks = std::min(shards, missions);
  if (expected.tasks == 0) return expected;
  const double tasks = static_cast<double>(expected.tasks);
  expected.missions = static_cast<double>(missions) / tasks;
  expected.core_s = ExpectedCoreS(stage) / tasks;
  if (expected.tasks == 1) return expected;
  const double spread = std::sqrt(variance_core_s2 / tasks) / expected.core_s;
  // The largest of as many normal draws (Blom 1958), corrected for the skewness of a gamma distribution of this spread
  // (the first term of Cornish and Fisher): a sum of few missions is skewed still.
  const double normal = quantile(boost::math::normal(), (tasks - 0.375) / (tasks + 0.25));
  expected.longest_over_mean = 1 + spread * (normal + (normal * normal - 1) / 6 * 2 * spread);
  return expected;
}

}  // namespace ed3r::app
