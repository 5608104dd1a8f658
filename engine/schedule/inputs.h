// What the missions of a plan share, read-only: their worlds and, where they look at pixels, what that takes.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "engine/perception/pixels/pixel_sensor.h"
#include "engine/sweep/plan.h"
#include "engine/world/scene.h"

namespace ed3r {

class Inputs {
 public:
  // Builds every world of the plan once, loads every detector once, and checks every arm against them: strategy, sites
  // in play, airframe. Throws UserError that names the sweep file and the arm. Also CheckTraining. Writes nothing.
  explicit Inputs(const SweepPlan& plan);

  const Scene& SceneOf(const Config& config) const;
  const PixelTier* PixelsOf(const Config& config) const;  // null in the fast tier

  // Fingerprint of everything in a file or in the program's data that results depend on, by name.
  std::map<std::string, std::string> Fingerprints(const SweepPlan& plan) const;

 private:
  void AddPixels(const Config& config);

  std::map<std::string, std::shared_ptr<const Scene>> scenes_;  // by mission.world
  std::map<std::string, PixelTier> pixels_;                     // by PixelKey
};

}  // namespace ed3r
