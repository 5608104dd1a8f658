// Fire and smoke: a flame cone under a leaning smoke column (FireShape), torn by turbulence that rises with time.
//
// A ray's way through the volumes is cut into samples once per sensing period; each frame then only looks up the
// noise that has drifted there. Solid things cut the way short, so trees and ridges hide fire and smoke.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/perception/render/ambience.h"
#include "engine/perception/render/shade.h"
#include "engine/perception/render/trace.h"
#include "engine/perception/render/turbulence.h"
#include "engine/world/scene.h"

namespace ed3r::perception {

// Ground truth of one view: what of fire and smoke the picture of a camera at rest shows, averaged over the flicker.
// A pixel counts where at least kVisibleOpacity of its light is flame, or smoke, after haze and fog.
struct GroundTruth {
  static constexpr float kVisibleOpacity = 0.15f;

  int fire_px = 0;
  int smoke_px = 0;
  double occluded = 0.0;    // share of the burning or smoking pixels in the frame that something solid hides
  double distance_m = 0.0;  // from the camera to the middle of the flame; 0 without a fire

  // R16, for both tiers.
  bool FireInView() const { return fire_px + smoke_px > 0; }
};

// Fire and smoke of several frames over the part of the grid that they cover: radiance to add, after the light from
// behind was multiplied by `through`.
struct PlumeLayers {
  int left = 0, top = 0, columns = 0, rows = 0;  // in the grid; no columns where no ray meets the plume
  struct Frame {
    RadiancePlanes added;
    std::vector<float> through;
  };
  std::vector<Frame> frames;
  GroundTruth truth;
};

PlumeLayers TracePlume(const SensingTrace& trace, const world::FireSite& site, const world::FireShape& shape,
                       const Ambience& ambience, const FogLayer& fog, std::span<const PlumePhase> phases);

}  // namespace ed3r::perception
