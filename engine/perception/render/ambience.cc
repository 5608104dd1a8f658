#include "engine/perception/render/ambience.h"

#include <cmath>
#include <numbers>

#include "engine/core/random.h"
#include "engine/perception/render/noise_volume.h"

namespace ed3r::perception {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// What weather = 0 gives: a clear summer noon.
constexpr double kNoonElevationDeg = 55.0;
constexpr double kClearHaze = 1.6;  // times perception.haze_range_m

}  // namespace

Ambience DrawAmbience(const PerceptionConfig& perception, std::uint64_t seed, std::uint32_t scenario) {
  const double weather = perception.render.weather;
  Stream stream(seed, scenario, Purpose::kAmbience);
  Ambience ambience;
  const double azimuth_rad = stream.Uniform(0.0, 2.0 * std::numbers::pi);
  // One mission in four has a low sun.
  const bool low_sun = stream.Uniform() < 0.25;
  const double drawn_deg = low_sun ? stream.Uniform(5.0, 18.0) : stream.Uniform(18.0, 68.0);
  const double elevation_rad = (kNoonElevationDeg + weather * (drawn_deg - kNoonElevationDeg)) * kDegree;
  ambience.to_sun = {static_cast<float>(std::cos(azimuth_rad) * std::cos(elevation_rad)),
                     static_cast<float>(std::sin(azimuth_rad) * std::cos(elevation_rad)),
                     static_cast<float>(std::sin(elevation_rad))};
  const double cover = stream.Uniform();
  ambience.cloud_cover = static_cast<float>(weather * cover);
  const double haze = std::exp(stream.Uniform(std::log(0.5), std::log(3.0)));
  ambience.haze_range_m =
      static_cast<float>(perception.haze_range_m * (kClearHaze + weather * (haze - kClearHaze)));
  const double season = stream.Uniform();
  ambience.autumn_share = static_cast<float>(weather * std::max(0.0, season - 0.5) * 0.9);
  ambience.dryness = static_cast<float>(0.35 + weather * stream.Uniform(-0.3, 0.5));
  ambience.smoke_tone = static_cast<float>(0.62 + weather * stream.Uniform(-0.3, 0.26));
  ambience.texture_shift = static_cast<float>(stream.Uniform(0.0, 64.0));

  // The lower the sun, the longer its way through the air: dimmer and redder. Clouds dim it and whiten the sky.
  const float height = ambience.to_sun.z();
  const float path = 1.0f / (height + 0.12f);
  const Colour clear_sun(Attenuation(0.055f * path), Attenuation(0.11f * path), Attenuation(0.22f * path));
  const float overcast = SmoothStep(0.7f, 1.0f, ambience.cloud_cover);
  ambience.sun = 1.35f * clear_sun * (1.0f - 0.8f * overcast);
  const float day = 0.35f + 0.65f * SmoothStep(0.0f, 0.6f, height);
  const Colour grey = Colour(0.74f, 0.77f, 0.82f) * day;
  ambience.zenith =
      Mix(Colour(0.20f, 0.36f, 0.72f) * day, grey, 0.3f * ambience.cloud_cover + 0.6f * overcast);
  const Colour pale =
      Mix(Colour(0.98f, 0.74f, 0.52f), Colour(0.66f, 0.78f, 0.92f), SmoothStep(0.1f, 0.45f, height));
  ambience.horizon = Mix(pale * day, grey, 0.3f * ambience.cloud_cover + 0.5f * overcast);
  ambience.haze = Mix(ambience.horizon, ambience.zenith, 0.25f) * 0.86f;
  return ambience;
}

Colour SkyAlong(const Ambience& ambience, const Eigen::Vector3f& direction) {
  const NoiseVolume& noise = NoiseVolume::Shared();
  const float up = direction.z();
  // A skyline of far mountains, as high as noise says for this azimuth.
  const float level = std::sqrt(std::max(1e-6f, 1.0f - up * up));
  const float east = direction.x() / level, north = direction.y() / level;
  const float skyline =
      0.012f +
      0.11f * std::max(0.0f, noise.At(2.1f * east + ambience.texture_shift, 2.1f * north, 0.3f) - 0.42f) +
      0.016f * noise.At(9.0f * east, 9.0f * north, 5.1f);
  const float rise = std::max(0.0f, up);
  Colour sky = Mix(ambience.horizon, ambience.zenith, std::sqrt(std::min(1.0f, 1.6f * rise)));
  const float cos_to_sun = direction.dot(ambience.to_sun);
  if (cos_to_sun > 0.0f) {
    const float near_sun = cos_to_sun * cos_to_sun * cos_to_sun * cos_to_sun;
    sky += ambience.sun * (0.25f * near_sun * near_sun);
  }
  if (ambience.cloud_cover > 0.02f && rise > 0.01f) {
    const float flat = 0.9f / (rise + 0.12f);
    const float puffs = noise.At(flat * direction.x() + ambience.texture_shift, flat * direction.y(), 2.5f);
    const float low = 0.72f - 0.5f * ambience.cloud_cover;
    const float cloud = SmoothStep(low, low + 0.2f, puffs) * std::min(1.0f, 8.0f * rise);
    const Colour lit = 0.55f * ambience.sun + 0.45f * ambience.horizon;
    sky = Mix(sky, lit * (1.1f - 0.5f * SmoothStep(low + 0.1f, low + 0.35f, puffs)), 0.85f * cloud);
  }
  if (up < skyline) {
    const Colour far_forest(0.10f, 0.14f, 0.13f);
    sky = Mix(far_forest, ambience.haze, 0.72f + 0.2f * (1.0f - up / skyline));
  }
  return sky;
}

Colour Glare(const Ambience& ambience, float cos_to_sun) {
  if (cos_to_sun <= 0.5f) return Colour::Zero();
  // 2 (1 - cos) is the squared angle for small angles.
  const float angle2 = 2.0f * (1.0f - cos_to_sun);
  const float disc = 60.0f * SmoothStep(0.0030f, 0.0012f, angle2);
  const float veil = 0.016f / (angle2 + 0.010f) - 0.0157f;
  return ambience.sun * (disc + std::max(0.0f, veil));
}

}  // namespace ed3r::perception
