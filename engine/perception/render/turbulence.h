// Turbulence of fire and smoke: what the samples on a ray through the plume add up to in each frame.
//
// Cutting a ray into samples is done once per sensing period; a frame only looks up the noise that has risen to each
// sample by its time, for up to kLanes frames at once.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace ed3r::perception {

// State of the turbulence in one frame.
struct PlumePhase {
  double time_s = 0.0;
  float puff = 0.0f;  // how much the flames swell, about -0.15 .. 0.15
};

inline constexpr float kFlameFeature_m = 3.2f;  // size of the largest whirls
inline constexpr float kFlameStretch = 1.6f;    // flames are longer than wide
inline constexpr float kSmokeFeature_m = 7.0f;
inline constexpr float kFineFeatures = 2.3f;  // a second noise is this much smaller; it rises faster

// A step of a ray through flame or smoke.
struct PlumeSample {
  const std::uint8_t* coarse;  // columns of NoiseVolume
  const std::uint8_t* fine;
  float density;   // mean; turbulence is added
  float length;    // of the step, times absorption
  float sunlight;  // smoke: how brightly it is lit, 0 .. 1
  float firelight;
  std::uint8_t coarse_z, fine_z;
  bool flame;
  bool hidden;  // behind something solid
};

// What the samples of a ray add up to, the nearest first. Optical depths; lights are weighted by smoke depth.
struct Absorbed {
  float smoke_depth = 0.0f, flame_depth = 0.0f, sunlight = 0.0f, firelight = 0.0f;
};

// The averaged plume: without turbulence. behind_solids: as if nothing were in the way.
Absorbed AbsorbMean(std::span<const PlumeSample> samples, bool behind_solids);

// Frames are worked on kLanes at a time, one in each lane of a vector.
inline constexpr int kLanes = 40;

// By how many cells the noise has risen in each frame.
struct LaneDrifts {
  int count = 0;  // a multiple of 8; the last lanes may repeat a frame
  std::array<int, kLanes> flame, flame_fine, smoke, smoke_fine;
  alignas(32) std::array<float, kLanes> puff;
};
struct LaneSums {
  alignas(32) std::array<float, kLanes> smoke_depth, flame_depth, sunlight, firelight;
};

LaneDrifts LanesOf(std::span<const PlumePhase> phases);  // 1 .. kLanes of them

// Up to the first hidden sample. The same bits on every instruction set.
void AbsorbInLanes(std::span<const PlumeSample> samples, const LaneDrifts& drifts, LaneSums& sums);

}  // namespace ed3r::perception
