#include "engine/perception/render/shade.h"

#include <algorithm>
#include <cmath>

#include "engine/perception/render/noise_volume.h"

namespace ed3r::perception {
namespace {

const Colour kGrass(0.13f, 0.19f, 0.055f);
const Colour kStraw(0.36f, 0.30f, 0.14f);
const Colour kSoil(0.19f, 0.135f, 0.085f);
const Colour kRock(0.30f, 0.28f, 0.255f);
const Colour kBark(0.13f, 0.095f, 0.07f);
const Colour kWall(0.58f, 0.54f, 0.47f);
const Colour kGlow(1.0f, 0.42f, 0.10f);
const Colour kLeaves[] = {
    {0.038f, 0.085f, 0.030f}, {0.060f, 0.115f, 0.030f}, {0.085f, 0.130f, 0.040f}, {0.045f, 0.090f, 0.045f}};
const Colour kAutumnLeaves[] = {{0.50f, 0.20f, 0.03f}, {0.52f, 0.34f, 0.05f}, {0.34f, 0.09f, 0.035f}};

constexpr double kSunRayM = 600.0;

// The surface of one pixel, ready for light.
struct Surface {
  Colour albedo;
  Eigen::Vector3f normal;
  float sky = 1.0f;   // share of the sky that lights it
  float wrap = 0.0f;  // how far light reaches around: leaves let some through
};

class Shader {
 public:
  Shader(const SensingTrace& trace, const world::Scene& scene, const Ambience& ambience,
         std::span<const Prop> props, const world::FireSite* fire)
      : trace_(trace), scene_(scene), ambience_(ambience), props_(props), noise_(NoiseVolume::Shared()) {
    for (const Prop& prop : props) {
      if (prop.kind == PropKind::kFog) fog_.push_back(&prop);
      if (prop.kind == PropKind::kRock) rocks_.push_back(&prop);
      if (prop.kind == PropKind::kAutumn) groves_.push_back(&prop);
    }
    if (fire != nullptr) {
      const world::FireShape& shape = scene.Fire();
      fire_m_ =
          fire->base_m.cast<float>() + Eigen::Vector3f(0, 0, 0.4f * static_cast<float>(shape.flame_height_m));
      glow_ = 1.3f;
      reach_m_ = static_cast<float>(shape.flame_radius_m);
    }
    const Eigen::Vector3d camera_m = trace.camera_m.cast<double>();
    const Eigen::Vector3d sun_m = camera_m + kSunRayM * ambience.to_sun.cast<double>();
    glare_ = !scene.Geometry().Occluded(camera_m, sun_m);
  }

  Colour Light(std::size_t i) const {
    if (trace_.material[i] == Material::kSky) return SkyAlong(ambience_, trace_.direction[i]);
    const Eigen::Vector3f point_m = trace_.PointM(i);
    const Surface surface = SurfaceAt(i, point_m);
    const float facing = surface.normal.dot(ambience_.to_sun);
    const float sun =
        trace_.sunlit[i] ? std::max(0.0f, (facing + surface.wrap) / (1.0f + surface.wrap)) : 0.0f;
    const float up = 0.5f + 0.5f * surface.normal.z();
    const Colour sky =
        (0.75f * ambience_.zenith + 0.3f * ambience_.horizon) * (0.25f + 0.75f * up) * surface.sky;
    Colour light = ambience_.sun * sun + sky;
    if (glow_ > 0.0f) light += kGlow * Glow(point_m, surface.normal);
    return Mix(ambience_.haze, surface.albedo * light,
               Attenuation(trace_.distance_m[i] / ambience_.haze_range_m));
  }

  // Light that the lens spreads around the sun's image; the disc itself only where the sky is seen.
  bool HasGlare() const { return glare_; }
  Colour Veil(std::size_t i) const {
    const Colour veil = Glare(ambience_, trace_.direction[i].dot(ambience_.to_sun));
    return trace_.material[i] == Material::kSky ? veil : veil.min(1.2f);
  }

  bool HasFog() const { return !fog_.empty(); }
  // Opacity of all banks in front of a pixel, and how far their middle is.
  std::pair<float, float> Fog(std::size_t i) const {
    const float end_m = std::min(trace_.distance_m[i], 1500.0f);
    float depth = 0.0f, weighted_m = 0.0f;
    for (const Prop* bank : fog_) {
      const Eigen::Vector3f towards = bank->position_m - trace_.camera_m;
      const float along = towards.dot(trace_.direction[i]);
      const float passes2 = towards.squaredNorm() - along * along;
      if (passes2 > bank->radius_m * bank->radius_m || along < -bank->radius_m) continue;
      const Eigen::Vector3f middle = trace_.camera_m + std::max(0.0f, along) * trace_.direction[i];
      const float wisps =
          0.35f + 1.3f * noise_.At(0.05f * middle.x(), 0.05f * middle.y(), 0.09f * middle.z());
      const float tau = wisps * FogDepth(*bank, trace_.camera_m, trace_.direction[i], end_m);
      depth += tau;
      weighted_m += tau * std::max(0.0f, along);
    }
    return {1.0f - Attenuation(depth), depth > 0.0f ? weighted_m / depth : 0.0f};
  }

 private:
  Surface SurfaceAt(std::size_t i, const Eigen::Vector3f& point_m) const {
    switch (trace_.material[i]) {
      case Material::kTerrain:
        return Ground(i, point_m);
      case Material::kCrown:
        return Crown(i, point_m);
      case Material::kTrunk: {
        const float streaks = noise_.At(point_m.x(), point_m.y(), 0.2f * point_m.z());
        return {kBark * (0.6f + 0.8f * streaks), trace_.normal[i], 0.55f, 0.0f};
      }
      case Material::kProp:
        return PropSurface(i);
      default:
        return FarGround(i, point_m);
    }
  }

  // How much of a pattern of the given size is left at a pixel that covers footprint_m of it.
  float Detail(std::size_t i, float size_m) const {
    const float footprint_m = trace_.distance_m[i] * trace_.pixel_rad;
    return std::clamp(1.6f - 2.0f * footprint_m / size_m, 0.0f, 1.0f);
  }

  Surface Ground(std::size_t i, const Eigen::Vector3f& p) const {
    const float wide = noise_.At(p.x() * 0.021f + ambience_.texture_shift, p.y() * 0.021f, 1.7f);
    const float patches = noise_.At(p.x() * 0.11f, p.y() * 0.11f, 4.2f) - 0.5f;
    const float tufts = (noise_.At(p.x() * 0.83f, p.y() * 0.83f, 6.6f) - 0.5f) * Detail(i, 0.9f);
    Colour albedo = Mix(kGrass, kStraw, std::clamp(ambience_.dryness + 1.6f * (wide - 0.5f), 0.0f, 1.0f));
    albedo = Mix(albedo, kSoil, SmoothStep(0.05f, 0.3f, patches));
    const float steep = 1.0f - trace_.normal[i].z();
    albedo = Mix(albedo, kRock, SmoothStep(0.22f, 0.34f, steep + 0.12f * patches));
    for (const Prop* rock : rocks_) {
      const float dx = p.x() - rock->position_m.x(), dy = p.y() - rock->position_m.y();
      const float r2 = (dx * dx + dy * dy) / (rock->radius_m * rock->radius_m);
      if (r2 < 1.5f) albedo = Mix(albedo, rock->colour, SmoothStep(1.15f, 0.85f, r2 + 1.2f * patches));
    }
    albedo *= 1.0f + 0.8f * patches + 0.9f * tufts;
    return {albedo.max(0.01f), trace_.normal[i], 0.9f, 0.0f};
  }

  Surface Crown(std::size_t i, const Eigen::Vector3f& p) const {
    const world::Tree& tree = scene_.Trees()[static_cast<std::size_t>(trace_.item[i])];
    const std::uint32_t bits = Scramble(static_cast<std::uint32_t>(trace_.item[i]) + 0x9e37U);
    Colour leaves = kLeaves[bits & 3] * (0.75f + 0.5f * UnitOf(Scramble(bits + 1)));
    if (UnitOf(Scramble(bits + 2)) < ambience_.autumn_share) leaves = kAutumnLeaves[(bits >> 4) % 3];
    for (const Prop* grove : groves_) {
      const float dx = static_cast<float>(tree.x_m) - grove->position_m.x();
      const float dy = static_cast<float>(tree.y_m) - grove->position_m.y();
      if (dx * dx + dy * dy < grove->radius_m * grove->radius_m)
        leaves = grove->colour * (0.7f + 0.5f * UnitOf(Scramble(bits + 3)));
    }
    // Clumps of leaves: they bend the surface and darken what lies between them.
    const float clumps = (noise_.At(0.55f * p.x(), 0.55f * p.y(), 0.4f * p.z()) - 0.5f) * Detail(i, 2.0f);
    const float tips = (noise_.At(1.9f * p.x(), 1.9f * p.y(), 1.5f * p.z()) - 0.5f) * Detail(i, 0.55f);
    const float height = (p.z() - static_cast<float>(tree.ground_m + tree.height_m - tree.crown_depth_m)) /
                         static_cast<float>(tree.crown_depth_m);
    Eigen::Vector3f normal = trace_.normal[i] + Eigen::Vector3f(1.3f * clumps, -1.1f * clumps, 1.5f * tips);
    normal /= std::max(1e-3f, normal.norm());
    const float open = std::clamp(0.35f + 0.65f * height + 1.2f * clumps + 0.9f * tips, 0.12f, 1.3f);
    return {leaves * std::max(0.3f, 1.0f + 1.1f * clumps + 1.3f * tips), normal, open, 0.35f};
  }

  Surface PropSurface(std::size_t i) const {
    const Prop& prop = props_[static_cast<std::size_t>(trace_.item[i] / 2)];
    const bool top = trace_.item[i] % 2 == 1;
    const bool roof_wall = prop.kind == PropKind::kRoof && !top;
    return {roof_wall ? kWall : prop.colour, trace_.normal[i], 0.9f, 0.0f};
  }

  // Forest beyond the area: patches that stand for crowns.
  Surface FarGround(std::size_t i, const Eigen::Vector3f& p) const {
    const float woods = noise_.At(0.012f * p.x(), 0.012f * p.y(), 3.3f);
    const float crowns = (noise_.At(0.16f * p.x(), 0.16f * p.y(), 0.9f) - 0.5f) * Detail(i, 5.0f);
    const float stands = noise_.At(0.045f * p.x(), 0.045f * p.y(), 6.1f);
    Colour forest = Mix(kLeaves[0], kLeaves[2], stands);
    forest = Mix(forest, kAutumnLeaves[1], ambience_.autumn_share * SmoothStep(0.45f, 0.65f, stands));
    forest *= 0.75f + 2.4f * std::max(-0.25f, crowns);
    const Colour open = Mix(kGrass, kStraw, ambience_.dryness) * (0.9f + 0.5f * crowns);
    return {Mix(forest, open, SmoothStep(0.56f, 0.62f, woods)), Eigen::Vector3f::UnitZ(), 0.7f, 0.0f};
  }

  float Glow(const Eigen::Vector3f& point_m, const Eigen::Vector3f& normal) const {
    const Eigen::Vector3f towards = fire_m_ - point_m;
    const float near2 = towards.squaredNorm() / (reach_m_ * reach_m_);
    if (near2 > 100.0f) return 0.0f;
    const float facing = normal.dot(towards) / (reach_m_ * std::sqrt(near2 + 1e-3f));
    return glow_ * std::max(0.0f, 0.25f + 0.75f * facing) / (0.6f + near2) * (1.0f - 0.01f * near2);
  }

  const SensingTrace& trace_;
  const world::Scene& scene_;
  const Ambience& ambience_;
  std::span<const Prop> props_;
  const NoiseVolume& noise_;
  std::vector<const Prop*> fog_, rocks_, groves_;
  Eigen::Vector3f fire_m_ = Eigen::Vector3f::Zero();
  float glow_ = 0.0f, reach_m_ = 1.0f;
  bool glare_ = false;
};

}  // namespace

StillPicture Shade(const SensingTrace& trace, const world::Scene& scene, const Ambience& ambience,
                   std::span<const Prop> props, const world::FireSite* fire) {
  const Shader shader(trace, scene, ambience, props, fire);
  const std::size_t pixels = trace.grid.Pixels();
  StillPicture still{.radiance = RadiancePlanes(pixels), .fog = {}, .mean = 0.0f};
  still.fog.colour = Mix(ambience.haze, 0.5f * ambience.sun + 0.5f * ambience.zenith, 0.3f);
  if (shader.HasFog()) {
    still.fog.opacity.resize(pixels);
    still.fog.distance_m.resize(pixels);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < pixels; ++i) {
    Colour colour = shader.Light(i);
    if (shader.HasFog()) {
      const auto [opacity, distance_m] = shader.Fog(i);
      colour = Mix(colour, still.fog.colour, opacity);
      still.fog.opacity[i] = opacity;
      still.fog.distance_m[i] = distance_m;
    }
    if (shader.HasGlare()) colour += shader.Veil(i);
    sum += std::min(colour[1], 2.0f);
    still.radiance.Set(i, colour);
  }
  still.mean = static_cast<float>(sum / static_cast<double>(pixels));
  return still;
}

}  // namespace ed3r::perception
