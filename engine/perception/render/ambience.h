// Sun, sky, weather and season of one mission, the same for all arms that fly its scenario.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "engine/config/perception.h"
#include "engine/perception/render/light.h"

namespace ed3r::perception {

struct Ambience {
  Eigen::Vector3f to_sun;       // unit
  Colour sun;                   // radiance of a white surface that faces it
  Colour zenith, horizon;       // of the sky
  Colour haze;                  // what distance fades into
  float haze_range_m = 600.0f;  // distance at which 1/e of a colour is left
  float cloud_cover = 0.0f;     // 0 .. 1
  float autumn_share = 0.0f;    // of the broad-leaved crowns
  float dryness = 0.0f;         // ground cover from green, 0, to straw, 1
  float smoke_tone = 0.5f;      // albedo of the smoke
  float texture_shift = 0.0f;   // moves clouds and ground patterns
};

Ambience DrawAmbience(const PerceptionConfig& perception, std::uint64_t seed, std::uint32_t scenario);

// Radiance of the sky along a unit direction that looks up or ahead; distant mountains stand on the horizon.
Colour SkyAlong(const Ambience& ambience, const Eigen::Vector3f& direction);

// Veil of light that the lens adds near the sun's image; cos_to_sun between the ray and the sun.
Colour Glare(const Ambience& ambience, float cos_to_sun);

}  // namespace ed3r::perception
