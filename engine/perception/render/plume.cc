#include "engine/perception/render/plume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/check.h"
#include "engine/perception/render/noise_volume.h"

namespace ed3r::perception {
namespace {

constexpr int kSteps = 24;      // samples on the way through the box around the plume
constexpr int kFineSteps = 80;  // in pictures for people, whose pixels are smaller than kFinePixel_rad
constexpr float kFinePixel_rad = 0.005f;
constexpr float kFlameAbsorption = 0.40f;  // 1/m of full density
constexpr float kSmokeAbsorption = 0.40f;
constexpr float kSpread = 1.25f;  // turbulence reaches this far beyond the mean radius

const Colour kEmber(2.2f, 0.34f, 0.03f), kFlame(4.2f, 1.45f, 0.16f), kCore(5.2f, 3.1f, 0.85f);
const Colour kFireLight(0.9f, 0.33f, 0.07f);

// What one pixel sees of the plume.
struct Glimpse {
  float flame = 0.0f;  // opacity of the flame, dimmed by smoke in front
  float smoke = 0.0f;  // opacity of the smoke
  float sunlight = 0.0f, firelight = 0.0f;
};

struct Interval {
  float from, to;
};

class Plume {
 public:
  Plume(const world::FireSite& site, const world::FireShape& shape, const Eigen::Vector3f& to_sun)
      : base_m_(site.base_m.cast<float>()),
        flame_height_m_(static_cast<float>(shape.flame_height_m)),
        flame_radius_m_(static_cast<float>(shape.flame_radius_m)),
        smoke_from_m_(0.55f * flame_height_m_),
        total_height_m_(static_cast<float>(shape.total_height_m)),
        top_radius_m_(static_cast<float>(shape.smoke_top_radius_m)),
        lean_(static_cast<float>(shape.lean_x_m), static_cast<float>(shape.lean_y_m)),
        to_sun_(to_sun),
        noise_(NoiseVolume::Shared()) {
    const float wide = kSpread * std::max(flame_radius_m_, top_radius_m_);
    low_ = Eigen::Vector3f(std::min(0.0f, lean_.x()) - wide, std::min(0.0f, lean_.y()) - wide, -1.0f);
    high_ = Eigen::Vector3f(std::max(0.0f, lean_.x()) + wide, std::max(0.0f, lean_.y()) + wide,
                            std::max(total_height_m_, 1.3f * flame_height_m_) + 2.0f);
    for (std::size_t i = 0; i < swing_m_.size(); ++i)
      swing_m_[i] =
          3.0f * flame_radius_m_ * (noise_.At(2.2f * static_cast<float>(i) / kSwings, 0.5f, 0.5f) - 0.5f);
  }

  // Part of a ray in the box around the plume; false for none.
  bool Crosses(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction, Interval& interval) const {
    const Eigen::Vector3f from = origin_m - base_m_;
    float enter = 0.0f, leave = std::numeric_limits<float>::max();
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(direction[axis]) < 1e-9f) {
        if (from[axis] < low_[axis] || from[axis] > high_[axis]) return false;
        continue;
      }
      const float a = (low_[axis] - from[axis]) / direction[axis],
                  b = (high_[axis] - from[axis]) / direction[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    interval = {enter, leave};
    return enter < leave;
  }

  // Appends the samples of one ray in which there can be flame or smoke, the nearest first.
  void Cut(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction, const Interval& interval,
           float solid_m, float dither, int steps, std::vector<PlumeSample>& samples) const {
    const float step_m = (interval.to - interval.from) / static_cast<float>(steps);
    const Eigen::Vector3f start = origin_m - base_m_;
    for (int k = 0; k < steps; ++k) {
      const float at_m = interval.from + (static_cast<float>(k) + dither) * step_m;
      const Eigen::Vector3f p = start + at_m * direction;
      const bool hidden = at_m > solid_m;
      if (p.z() < 0.0f) continue;
      AddFlame(p, step_m, hidden, samples);
      AddSmoke(p, step_m, hidden, samples);
    }
  }

 private:
  void AddFlame(const Eigen::Vector3f& p, float step_m, bool hidden,
                std::vector<PlumeSample>& samples) const {
    const float height = p.z() / (1.15f * flame_height_m_);
    if (height >= 1.0f) return;
    // Full at the foot, drawn to a tip.
    const float radius_m = flame_radius_m_ * (1.0f - height) * (1.0f + 0.9f * height);
    const float q2 = (p.x() * p.x() + p.y() * p.y()) / (radius_m * radius_m);
    if (q2 > kSpread * kSpread) return;
    const float density = 1.15f * (1.0f - q2) - 0.45f * height;
    samples.push_back(At(p, kFlameFeature_m, kFlameStretch, density, kFlameAbsorption * step_m, hidden));
    samples.back().flame = true;
  }

  void AddSmoke(const Eigen::Vector3f& p, float step_m, bool hidden,
                std::vector<PlumeSample>& samples) const {
    const float rise = (p.z() - smoke_from_m_) / (total_height_m_ - smoke_from_m_);
    if (rise <= 0.0f || rise >= 1.0f) return;
    const float swing_m = rise * swing_m_[static_cast<std::size_t>(rise * kSwings)];
    const float x = p.x() - rise * lean_.x() - swing_m, y = p.y() - rise * lean_.y() + swing_m;
    const float radius_m = 0.55f * flame_radius_m_ + rise * (top_radius_m_ - 0.55f * flame_radius_m_);
    const float q2 = (x * x + y * y) / (radius_m * radius_m);
    if (q2 > kSpread * kSpread) return;
    const float fade = SmoothStep(0.0f, 0.15f, rise) * SmoothStep(1.0f, 0.7f, rise);
    const float density = (0.85f - q2) * fade - 0.35f * (1.0f - fade);
    samples.push_back(
        At(p, kSmokeFeature_m, 1.0f, density, kSmokeAbsorption * (1.0f - 0.62f * rise) * step_m, hidden));
    PlumeSample& sample = samples.back();
    const float towards_sun = (x * to_sun_.x() + y * to_sun_.y()) / radius_m + 0.6f * to_sun_.z();
    sample.sunlight = std::clamp(0.55f + 0.45f * towards_sun, 0.12f, 1.0f);
    sample.firelight = Attenuation(4.0f * rise);
  }

  PlumeSample At(const Eigen::Vector3f& p, float feature_m, float stretch, float density, float length,
                 bool hidden) const {
    const float scale = NoiseVolume::kCellsPerUnit / feature_m;
    const auto cell = [](float x) { return static_cast<int>(x + 65536.0f) & (NoiseVolume::kCells - 1); };
    const float z = p.z() / stretch;
    PlumeSample sample{};
    sample.coarse = noise_.Column(cell(p.x() * scale), cell(p.y() * scale));
    sample.fine = noise_.Column(cell(p.x() * scale * kFineFeatures + 17.0f),
                                cell(p.y() * scale * kFineFeatures + 29.0f));
    sample.coarse_z = static_cast<std::uint8_t>(cell(z * scale));
    sample.fine_z = static_cast<std::uint8_t>(cell(z * scale * kFineFeatures));
    sample.density = density;
    sample.length = length;
    sample.hidden = hidden;
    return sample;
  }

  Eigen::Vector3f base_m_;
  float flame_height_m_, flame_radius_m_, smoke_from_m_, total_height_m_, top_radius_m_;
  Eigen::Vector2f lean_;
  Eigen::Vector3f to_sun_;
  const NoiseVolume& noise_;
  Eigen::Vector3f low_, high_;  // of the box, from the base
  static constexpr int kSwings = 64;
  std::array<float, kSwings + 1> swing_m_;  // how far the smoke's axis bends, from its foot to its top
};

Glimpse GlimpseOf(const Absorbed& sum) {
  Glimpse glimpse{1.0f - Attenuation(sum.flame_depth), 1.0f - Attenuation(sum.smoke_depth), 0.0f, 0.0f};
  if (sum.smoke_depth > 0.0f) {
    glimpse.sunlight = sum.sunlight / sum.smoke_depth;
    glimpse.firelight = sum.firelight / sum.smoke_depth;
  }
  return glimpse;
}

// Light of flames by their opacity: embers at the rim, a bright core.
Colour FlameLight(float opacity) {
  return opacity < 0.6f ? Mix(kEmber, kFlame, opacity / 0.6f) : Mix(kFlame, kCore, (opacity - 0.6f) / 0.4f);
}

class LayerBuilder {
 public:
  LayerBuilder(const SensingTrace& trace, const Plume& plume, const world::FireSite& site,
               const Ambience& ambience, const FogLayer& fog, std::span<const PlumePhase> phases)
      : trace_(trace), plume_(plume), ambience_(ambience), fog_(fog) {
    distance_m_ = (site.base_m.cast<float>() - trace.camera_m).norm();
    haze_ = 1.0f - Attenuation(distance_m_ / ambience.haze_range_m);
    frames_ = phases.size();
    for (std::size_t first = 0; first < frames_; first += kLanes)
      drifts_.push_back(LanesOf(phases.subspan(first, std::min<std::size_t>(kLanes, frames_ - first))));
  }

  PlumeLayers Build() {
    PlumeLayers layers;
    FindExtent(layers);
    if (layers.columns == 0) return layers;
    const std::size_t pixels =
        static_cast<std::size_t>(layers.columns) * static_cast<std::size_t>(layers.rows);
    layers.frames.resize(frames_);
    for (PlumeLayers::Frame& frame : layers.frames) {
      frame.added = RadiancePlanes(pixels);
      frame.through.assign(pixels, 1.0f);
    }
    for (int row = 0; row < layers.rows; ++row) AddRow(layers, row);
    if (covered_px_ > 0) layers.truth.occluded = 1.0 - static_cast<double>(uncovered_px_) / covered_px_;
    return layers;
  }

 private:
  struct Ray {
    std::size_t pixel;   // in the grid
    std::size_t target;  // in the layer
    std::size_t first, count;
  };

  void FindExtent(PlumeLayers& layers) {
    const PixelGrid& grid = trace_.grid;
    int left = grid.Columns(), right = -1, top = grid.Rows(), bottom = -1;
    Interval interval{};
    std::size_t i = 0;
    for (int row = 0; row < grid.Rows(); ++row)
      for (int column = 0; column < grid.Columns(); ++column, ++i) {
        if (!plume_.Crosses(trace_.camera_m, trace_.direction[i], interval)) continue;
        left = std::min(left, column);
        right = std::max(right, column);
        top = std::min(top, row);
        bottom = std::max(bottom, row);
      }
    if (right < left) return;
    layers.left = left;
    layers.top = top;
    layers.columns = right - left + 1;
    layers.rows = bottom - top + 1;
  }

  void AddRow(PlumeLayers& layers, int row) {
    samples_.clear();
    rays_.clear();
    const int steps = trace_.pixel_rad < kFinePixel_rad ? kFineSteps : kSteps;
    Interval interval{};
    for (int column = 0; column < layers.columns; ++column) {
      const std::size_t pixel =
          static_cast<std::size_t>(layers.top + row) * trace_.grid.Columns() + layers.left + column;
      if (!plume_.Crosses(trace_.camera_m, trace_.direction[pixel], interval)) continue;
      const std::size_t first = samples_.size();
      plume_.Cut(trace_.camera_m, trace_.direction[pixel], interval, trace_.distance_m[pixel],
                 UnitOf(Scramble(static_cast<std::uint32_t>(pixel))), steps, samples_);
      if (samples_.size() == first) continue;
      rays_.push_back(
          {pixel, static_cast<std::size_t>(row) * layers.columns + column, first, samples_.size() - first});
      if (trace_.grid.InPicture(layers.left + column, layers.top + row)) Count(rays_.back(), layers.truth);
    }
    for (std::size_t group = 0; group < drifts_.size(); ++group)
      for (const Ray& ray : rays_) AddRay(layers, ray, group);
  }

  void AddRay(PlumeLayers& layers, const Ray& ray, std::size_t group) const {
    LaneSums sums;
    AbsorbInLanes(SamplesOf(ray), drifts_[group], sums);
    const std::size_t first = group * kLanes, count = std::min<std::size_t>(kLanes, frames_ - first);
    for (std::size_t k = 0; k < count; ++k) {
      if (sums.flame_depth[k] + sums.smoke_depth[k] < 0.002f) continue;
      Paint(GlimpseOf({sums.smoke_depth[k], sums.flame_depth[k], sums.sunlight[k], sums.firelight[k]}), ray,
            layers.frames[first + k]);
    }
  }

  std::span<const PlumeSample> SamplesOf(const Ray& ray) const {
    return std::span<const PlumeSample>(samples_).subspan(ray.first, ray.count);
  }

  void Count(const Ray& ray, GroundTruth& truth) {
    const Glimpse open = GlimpseOf(AbsorbMean(SamplesOf(ray), true));
    if (std::max(open.flame, open.smoke) < GroundTruth::kVisibleOpacity) return;
    ++covered_px_;
    const Glimpse seen = GlimpseOf(AbsorbMean(SamplesOf(ray), false));
    if (std::max(seen.flame, seen.smoke) >= GroundTruth::kVisibleOpacity) ++uncovered_px_;
    const float clear = (1.0f - haze_) * (1.0f - FogInFront(ray.pixel));
    if (seen.flame * clear >= GroundTruth::kVisibleOpacity) ++truth.fire_px;
    if (seen.smoke * clear >= GroundTruth::kVisibleOpacity) ++truth.smoke_px;
  }

  float FogInFront(std::size_t pixel) const {
    return !fog_.opacity.empty() && fog_.distance_m[pixel] < distance_m_ ? fog_.opacity[pixel] : 0.0f;
  }

  void Paint(const Glimpse& glimpse, const Ray& ray, PlumeLayers::Frame& frame) const {
    const Colour lit = ambience_.smoke_tone * (ambience_.sun * glimpse.sunlight + 0.55f * ambience_.horizon +
                                               0.25f * ambience_.zenith) +
                       kFireLight * glimpse.firelight;
    const float smoke = glimpse.smoke * (1.0f - glimpse.flame);
    const float through = 1.0f - glimpse.flame - smoke;
    Colour added = lit * smoke + FlameLight(glimpse.flame) * glimpse.flame;
    added = added * (1.0f - haze_) + ambience_.haze * (haze_ * (1.0f - through));
    if (const float fog = FogInFront(ray.pixel); fog > 0.0f)
      added = added * (1.0f - fog) + fog_.colour * (fog * (1.0f - through));
    frame.added.Set(ray.target, added);
    frame.through[ray.target] = through;
  }

  const SensingTrace& trace_;
  const Plume& plume_;
  const Ambience& ambience_;
  const FogLayer& fog_;
  float distance_m_ = 0.0f, haze_ = 0.0f;
  std::size_t frames_ = 0;
  std::vector<LaneDrifts> drifts_;
  std::vector<PlumeSample> samples_;
  std::vector<Ray> rays_;
  int covered_px_ = 0, uncovered_px_ = 0;
};

}  // namespace

PlumeLayers TracePlume(const SensingTrace& trace, const world::FireSite& site, const world::FireShape& shape,
                       const Ambience& ambience, const FogLayer& fog, std::span<const PlumePhase> phases) {
  const Plume plume(site, shape, ambience.to_sun);
  PlumeLayers layers = LayerBuilder(trace, plume, site, ambience, fog, phases).Build();
  const Eigen::Vector3f middle_m =
      site.base_m.cast<float>() + Eigen::Vector3f(0, 0, 0.5f * static_cast<float>(shape.flame_height_m));
  layers.truth.distance_m = (middle_m - trace.camera_m).norm();
  return layers;
}

}  // namespace ed3r::perception
