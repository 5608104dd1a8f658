// What the missions of a plan share, read-only: their worlds and, where they look at pixels, what that takes.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "engine/agents/context.h"
#include "engine/perception/pixels/pixel_sensor.h"
#include "engine/rfnn/onnx_network.h"
#include "engine/schedule/input_files.h"
#include "engine/sweep/plan.h"
#include "engine/world/scene.h"

namespace ed3r::schedule {

// What is wrong with a plan whatever is in its files: training stages (CheckTraining), strategies, airframes. Throws
// UserError that names the sweep file and the arm. Opens nothing.
void CheckPlan(const sweep::SweepPlan& plan);

class Inputs {
 public:
  // Builds every world of the plan once, loads every detector once, and checks every arm against them: sites in play.
  // Throws UserError that names the sweep file and the arm. Also CheckPlan. Writes nothing.
  explicit Inputs(const sweep::SweepPlan& plan);

  const world::Scene& SceneOf(const Config& config) const;
  const perception::PixelTier* PixelsOf(const Config& config) const;  // null in the fast tier
  agents::Networks NetworksOf(const Config& config) const;  // the user's own; null where they are trained

  // The files as they were before the first of them was opened, for who keeps them. UserError where one has changed since.
  InputFiles Files(const sweep::SweepPlan& plan) const;

  // Fingerprint of everything in a file or in the program's data that results depend on, by name.
  std::map<std::string, std::string> Fingerprints(const sweep::SweepPlan& plan) const;

 private:
  void AddPixels(const Config& config);
  void AddNetworks(const Config& config);

  std::optional<InputFiles> files_;  // none where one cannot be read: whoever needs it tells
  std::map<std::string, std::shared_ptr<const world::Scene>> scenes_;  // by mission.world
  std::map<std::string, perception::PixelTier> pixels_;                // by PixelKey
  std::map<std::string, std::shared_ptr<const rfnn::OnnxNetwork>> rc_networks_, robot_networks_;  // by path
};

}  // namespace ed3r::schedule
