#include "engine/perception/render/turbulence.h"

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"
#include "engine/perception/render/noise_volume.h"

namespace ed3r::perception {
namespace {

constexpr float kMeanNoise = 0.5f;
constexpr float kFlameTurbulence = 2.6f;
constexpr float kSmokeTurbulence = 3.6f;
constexpr float kFlameRise_mps = 8.0f;
constexpr float kSmokeRise_mps = 4.5f;
constexpr float kFineRise = 1.35f;

// Written so that a loop over it becomes vector minimum and maximum.
__attribute__((always_inline)) inline float Clamp01(float x) {
  x = x < 1.0f ? x : 1.0f;
  return x > 0.0f ? x : 0.0f;
}

// noise: 0 .. 1. Light of the flame is dimmed by the smoke before it.
__attribute__((always_inline)) inline void AbsorbFlame(const PlumeSample& sample, float noise, float puff,
                                                       const float& smoke_depth, float& flame_depth) {
  const float density = Clamp01(sample.density + puff + kFlameTurbulence * (noise - kMeanNoise));
  flame_depth += density * sample.length / (1.0f + smoke_depth * (1.0f + 0.5f * smoke_depth));
}
__attribute__((always_inline)) inline void AbsorbSmoke(const PlumeSample& sample, float noise,
                                                       float& smoke_depth, float& sunlight,
                                                       float& firelight) {
  const float depth = Clamp01(sample.density + kSmokeTurbulence * (noise - kMeanNoise)) * sample.length;
  smoke_depth += depth;
  sunlight += depth * sample.sunlight;
  firelight += depth * sample.firelight;
}

// Plain loops over lanes: the compiler makes vectors of them, and since nothing is fused or reordered, every
// instruction set gives the same sums.
__attribute__((always_inline)) inline void AbsorbLanes(std::span<const PlumeSample> samples,
                                                       const LaneDrifts& drifts, LaneSums& sums) {
  constexpr int kMask = NoiseVolume::kCells - 1;
  const int lanes = drifts.count;
  sums = {};
  alignas(32) std::array<std::int32_t, kLanes> coarse, fine;
  for (const PlumeSample& sample : samples) {
    if (sample.hidden) break;
    const int* drift = sample.flame ? drifts.flame.data() : drifts.smoke.data();
    const int* drift_fine = sample.flame ? drifts.flame_fine.data() : drifts.smoke_fine.data();
    for (int k = 0; k < lanes; ++k) {
      coarse[k] = sample.coarse[(sample.coarse_z - drift[k]) & kMask];
      fine[k] = sample.fine[(sample.fine_z - drift_fine[k]) & kMask];
    }
    const auto noise = [&](int k) {
      return (0.62f / 255.0f) * static_cast<float>(coarse[k]) +
             (0.38f / 255.0f) * static_cast<float>(fine[k]);
    };
    if (sample.flame) {
      for (int k = 0; k < lanes; ++k)
        AbsorbFlame(sample, noise(k), drifts.puff[k], sums.smoke_depth[k], sums.flame_depth[k]);
    } else {
      for (int k = 0; k < lanes; ++k)
        AbsorbSmoke(sample, noise(k), sums.smoke_depth[k], sums.sunlight[k], sums.firelight[k]);
    }
  }
}

// Cells by which the noise has risen after a time.
int Risen(double time_s, float rise_mps, float feature_m) {
  const double moved = time_s * rise_mps / feature_m * NoiseVolume::kCellsPerUnit;
  return static_cast<int>(std::lround(std::fmod(moved, NoiseVolume::kCells)));
}

using LaneFunction = void (*)(std::span<const PlumeSample>, const LaneDrifts&, LaneSums&);

void AbsorbLanesBaseline(std::span<const PlumeSample> samples, const LaneDrifts& drifts, LaneSums& sums) {
  AbsorbLanes(samples, drifts, sums);
}
#if defined(__x86_64__)
__attribute__((target("avx2"))) void AbsorbLanesAvx2(std::span<const PlumeSample> samples,
                                                     const LaneDrifts& drifts, LaneSums& sums) {
  AbsorbLanes(samples, drifts, sums);
}
#endif
LaneFunction ChooseLaneFunction() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return AbsorbLanesAvx2;
#endif
  return AbsorbLanesBaseline;
}

}  // namespace

Absorbed AbsorbMean(std::span<const PlumeSample> samples, bool behind_solids) {
  Absorbed sum;
  for (const PlumeSample& sample : samples) {
    if (sample.hidden && !behind_solids) break;
    if (sample.flame)
      AbsorbFlame(sample, kMeanNoise, 0.0f, sum.smoke_depth, sum.flame_depth);
    else
      AbsorbSmoke(sample, kMeanNoise, sum.smoke_depth, sum.sunlight, sum.firelight);
  }
  return sum;
}

LaneDrifts LanesOf(std::span<const PlumePhase> phases) {
  ED3R_CHECK(!phases.empty() && phases.size() <= kLanes, "frames in one group");
  LaneDrifts drifts{};
  drifts.count = static_cast<int>((phases.size() + 7) / 8 * 8);
  for (std::size_t k = 0; k < static_cast<std::size_t>(drifts.count); ++k) {
    const PlumePhase& phase = phases[std::min(k, phases.size() - 1)];
    drifts.flame[k] = Risen(phase.time_s, kFlameRise_mps, kFlameStretch * kFlameFeature_m);
    drifts.flame_fine[k] =
        Risen(phase.time_s, kFineRise * kFlameRise_mps, kFlameStretch * kFlameFeature_m / kFineFeatures);
    drifts.smoke[k] = Risen(phase.time_s, kSmokeRise_mps, kSmokeFeature_m);
    drifts.smoke_fine[k] = Risen(phase.time_s, kFineRise * kSmokeRise_mps, kSmokeFeature_m / kFineFeatures);
    drifts.puff[k] = phase.puff;
  }
  return drifts;
}

void AbsorbInLanes(std::span<const PlumeSample> samples, const LaneDrifts& drifts, LaneSums& sums) {
  static const LaneFunction absorb_lanes = ChooseLaneFunction();
  absorb_lanes(samples, drifts, sums);
}

}  // namespace ed3r::perception
