#include "engine/schedule/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <vector>

#include "engine/agents/strategy.h"
#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/mission/scenario.h"
#include "engine/robot/airframe.h"
#include "engine/robot/energy.h"
#include "engine/schedule/parallel_for.h"
#include "engine/schedule/scheduler.h"
#include "engine/schedule/training_stage.h"
#include "engine/sweep/setting.h"

namespace ed3r::schedule {
namespace {

// Tells of which arm an error is.
template <class Check>
void OfArm(const sweep::SweepPlan& plan, const sweep::Arm& arm, Check check) {
  try {
    check();
  } catch (const UserError& error) {
    throw UserError(fmt::format("{}: arm {}: {}", plan.file, arm.name, error.what()));
  }
}

// Arms that look at the same scene with the same detectors share them.
std::string PixelKey(const Config& config) {
  Config detector;
  detector.perception.detector = config.perception.detector;
  return config.mission.world + "\n" + CanonicalText(detector);
}

// Every world of the plan, loaded side by side. The error is that of the first world that has one.
std::map<std::string, std::shared_ptr<const world::Scene>> LoadScenes(const sweep::SweepPlan& plan) {
  std::vector<std::string> files;
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      if (std::find(files.begin(), files.end(), arm.config.mission.world) == files.end())
        files.push_back(arm.config.mission.world);
  std::vector<std::shared_ptr<const world::Scene>> scenes(files.size());
  std::vector<std::exception_ptr> errors(files.size());
  const int threads = std::min(ThreadsFor(0), static_cast<int>(files.size()));
  ParallelFor(std::max(threads, 1), static_cast<std::int64_t>(files.size()), [&](std::int64_t i) {
    const auto at = static_cast<std::size_t>(i);
    try {
      scenes[at] = world::Scene::Load(files[at]);
    } catch (...) {
      errors[at] = std::current_exception();
    }
  });
  std::map<std::string, std::shared_ptr<const world::Scene>> loaded;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (errors[i]) std::rethrow_exception(errors[i]);
    loaded[files[i]] = scenes[i];
  }
  return loaded;
}

}  // namespace

void CheckPlan(const sweep::SweepPlan& plan) {
  CheckTraining(plan);
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      OfArm(plan, arm, [&] {
        agents::FindStrategy(arm.config.mission.strategy);
        for (const std::string& problem :
             {robot::CheckFlyable(arm.config), robot::CheckBilledPower(arm.config)})
          if (!problem.empty()) throw UserError(problem);
      });
}

Inputs::Inputs(const sweep::SweepPlan& plan) {
  CheckPlan(plan);
  try {
    files_ = ReadInputFiles(plan);
  } catch (const UserError&) {
  }
  scenes_ = LoadScenes(plan);
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      OfArm(plan, arm, [&] {
        mission::DealScenario(SceneOf(arm.config), arm.config.mission, plan.seed, 0);
        AddPixels(arm.config);
        AddNetworks(arm.config);
      });
}

void Inputs::AddPixels(const Config& config) {
  if (config.perception.tier != PerceptionTier::kPixels) return;
  perception::PixelTier& tier = pixels_[PixelKey(config)];
  if (tier.scene) return;
  tier.detectors = perception::LoadDetectors(config.perception.detector);
  tier.scene = std::make_shared<const perception::TraceScene>(SceneOf(config));
}

void Inputs::AddNetworks(const Config& config) {
  const agents::Strategy& strategy = agents::FindStrategy(config.mission.strategy);
  const auto add = [&](const char* key, const std::string& file, bool asked,
                       const rfnn::NetworkDesign& design, auto& networks) {
    if (file == sweep::FileNotNeeded(key) || networks.contains(file)) return;
    if (!asked)
      throw UserError(
          fmt::format("{}: '{}' is not allowed; strategy {} asks no such network", key, file, strategy.name));
    networks[file] = rfnn::OnnxNetwork::Read(file, key, design);
  };
  add("networks.rc", config.networks.rc, strategy.motion.asks_network, rfnn::kRcNetwork, rc_networks_);
  add("networks.robot", config.networks.robot, strategy.execution.asks_network, rfnn::kRobotNetwork,
      robot_networks_);
}

agents::Networks Inputs::NetworksOf(const Config& config) const {
  const auto find = [](const auto& networks, const std::string& file) -> const rfnn::OnnxNetwork* {
    const auto found = networks.find(file);
    return found == networks.end() ? nullptr : found->second.get();
  };
  agents::Networks own;
  if (const rfnn::OnnxNetwork* rc = find(rc_networks_, config.networks.rc)) {
    own.rc = rc->scores();
    own.direct_rc = rc->direct();
  }
  if (const rfnn::OnnxNetwork* robot = find(robot_networks_, config.networks.robot)) {
    own.robot = robot->scores();
    own.direct_robot = robot->direct();
  }
  return own;
}

InputFiles Inputs::Files(const sweep::SweepPlan& plan) const {
  InputFiles now = ReadInputFiles(plan);
  if (!files_ || files_->places != now.places || files_->files.size() != now.files.size())
    throw UserError(
        fmt::format("{}: files that it reads came or went while they were read; start it again", plan.file));
  for (std::size_t i = 0; i < now.files.size(); ++i)
    if (!(files_->files[i] == now.files[i]))
      throw UserError(
          fmt::format("{}: {} was changed while it was read; start it again", plan.file, now.files[i].name));
  return now;
}

const world::Scene& Inputs::SceneOf(const Config& config) const { return *scenes_.at(config.mission.world); }

const perception::PixelTier* Inputs::PixelsOf(const Config& config) const {
  return config.perception.tier == PerceptionTier::kPixels ? &pixels_.at(PixelKey(config)) : nullptr;
}

std::map<std::string, std::string> Inputs::Fingerprints(const sweep::SweepPlan& plan) const {
  std::map<std::string, std::string> fingerprints;
  for (const sweep::Stage& stage : plan.stages) {
    for (const sweep::Arm& arm : stage.arms) {
      const Config named = arm.CanonicalConfig();
      fingerprints[named.mission.world] = SceneOf(arm.config).Fingerprint();
      const auto add = [&](const auto& networks, const std::string& file, const std::string& called) {
        const auto found = networks.find(file);
        if (found != networks.end())
          fingerprints[fmt::format("network {}", called)] = found->second->sha256();
      };
      add(rc_networks_, arm.config.networks.rc, named.networks.rc);
      add(robot_networks_, arm.config.networks.robot, named.networks.robot);
      if (const perception::PixelTier* pixels = PixelsOf(arm.config)) {
        const DetectorConfig& detector = named.perception.detector;
        fingerprints[fmt::format("detectors {}, {}", detector.full, detector.quantized)] =
            pixels->detectors.fingerprint;
      }
    }
  }
  return fingerprints;
}

}  // namespace ed3r::schedule
