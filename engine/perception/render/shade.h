// Light on what a trace met: the still picture of a sensing period, to which fire and smoke are added frame by frame.
#pragma once

#include <span>
#include <vector>

#include "engine/perception/render/ambience.h"
#include "engine/perception/render/props.h"
#include "engine/perception/render/trace.h"
#include "engine/world/scene.h"

namespace ed3r::perception {

// Linear radiance in three planes, as the grid lies.
struct RadiancePlanes {
  std::vector<float> red, green, blue;
  explicit RadiancePlanes(std::size_t pixels = 0) : red(pixels), green(pixels), blue(pixels) {}
  void Set(std::size_t i, const Colour& colour) {
    red[i] = colour[0];
    green[i] = colour[1];
    blue[i] = colour[2];
  }
  Colour At(std::size_t i) const { return {red[i], green[i], blue[i]}; }
};

// Mist in front of the solid world.
struct FogLayer {
  std::vector<float> opacity;     // empty where no bank is near the picture
  std::vector<float> distance_m;  // of its middle
  Colour colour = Colour::Zero();
};

struct StillPicture {
  RadiancePlanes radiance;  // with haze, fog and glare
  FogLayer fog;
  float mean = 0.0f;  // radiance over the picture, green; sets the exposure
};

// fire: whose glow lights its surroundings; none where it is null.
StillPicture Shade(const SensingTrace& trace, const world::Scene& scene, const Ambience& ambience,
                   std::span<const Prop> props, const world::FireSite* fire);

}  // namespace ed3r::perception
