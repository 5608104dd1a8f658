#include "engine/perception/render/props.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/perception/view.h"

namespace ed3r::perception {
namespace {

constexpr float kFogFlatness = 0.35f;  // height of a bank over its radius
constexpr float kFogRadii = 9.0f;      // radius of a bank over that of its distractor
constexpr float kGroveRadii = 3.5f;
constexpr float kRockRadii = 1.6f;
constexpr float kRoofPitch = 0.7f;  // rise over run

const Colour kRoofColours[] = {
    {0.55f, 0.13f, 0.07f}, {0.62f, 0.22f, 0.09f}, {0.42f, 0.10f, 0.08f}, {0.35f, 0.33f, 0.32f}};
const Colour kVehicleColours[] = {
    {0.62f, 0.05f, 0.04f}, {0.75f, 0.34f, 0.03f}, {0.78f, 0.60f, 0.05f}, {0.75f, 0.75f, 0.73f}};
const Colour kRockColours[] = {{0.62f, 0.55f, 0.45f}, {0.70f, 0.48f, 0.30f}, {0.58f, 0.57f, 0.55f}};
const Colour kAutumnColours[] = {{0.62f, 0.22f, 0.03f}, {0.68f, 0.40f, 0.04f}, {0.48f, 0.11f, 0.04f}};

template <std::size_t kCount>
const Colour& Pick(const Colour (&colours)[kCount], Stream& stream) {
  return colours[stream.Below(kCount)];
}

Eigen::Vector3f Turned(const Prop& prop, const Eigen::Vector3f& v) {
  return {prop.cos_yaw * v.x() + prop.sin_yaw * v.y(), -prop.sin_yaw * v.x() + prop.cos_yaw * v.y(), v.z()};
}
Eigen::Vector3f TurnedBack(const Prop& prop, const Eigen::Vector3f& v) {
  return {prop.cos_yaw * v.x() - prop.sin_yaw * v.y(), prop.sin_yaw * v.x() + prop.cos_yaw * v.y(), v.z()};
}

// A convex body as planes n.x <= d, cut one after the other.
class ConvexCut {
 public:
  ConvexCut(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction)
      : origin_(origin), direction_(direction) {}

  void Cut(const Eigen::Vector3f& normal, float offset, bool top) {
    const float along = normal.dot(direction_);
    const float room = offset - normal.dot(origin_);
    if (along == 0.0f) {
      if (room < 0.0f) exit_ = -1.0f;
    } else if (const float t = room / along; along < 0.0f) {
      if (t > entry_) {
        entry_ = t;
        normal_ = normal;
        top_ = top;
      }
    } else {
      exit_ = std::min(exit_, t);
    }
  }
  bool Hit(PropHit& hit) const {
    if (entry_ >= exit_ || entry_ <= 0.0f) return false;
    hit = {entry_, normal_, top_};
    return true;
  }

 private:
  Eigen::Vector3f origin_, direction_;
  float entry_ = 0.0f, exit_ = std::numeric_limits<float>::infinity();
  Eigen::Vector3f normal_ = Eigen::Vector3f::UnitZ();
  bool top_ = false;
};

void Shape(Prop& prop, float radius_m, Stream& stream) {
  switch (prop.kind) {
    case PropKind::kRoof:
      prop.half_size_m = Eigen::Vector3f(1.5f, 1.0f, 0.8f) * (1.2f * radius_m);
      prop.colour = Pick(kRoofColours, stream);
      break;
    case PropKind::kVehicle:
      prop.half_size_m = {2.4f, 1.0f, 0.85f};
      prop.colour = Pick(kVehicleColours, stream);
      break;
    case PropKind::kRock:
      prop.radius_m = kRockRadii * radius_m;
      prop.colour = Pick(kRockColours, stream);
      return;
    case PropKind::kAutumn:
      prop.radius_m = kGroveRadii * radius_m;
      prop.colour = Pick(kAutumnColours, stream);
      return;
    case PropKind::kFog:
      prop.radius_m = kFogRadii * radius_m;
      prop.colour = Colour(0.82f, 0.84f, 0.87f);
      return;
  }
  const Eigen::Vector3f& half = prop.half_size_m;
  // The ridge of a gable roof is higher than its box.
  const float high = prop.kind == PropKind::kRoof ? 2.0f * half.z() + kRoofPitch * half.y() : 2.0f * half.z();
  prop.radius_m = std::sqrt(half.x() * half.x() + half.y() * half.y() + high * high);
}

}  // namespace

std::string_view NameOf(PropKind kind) {
  constexpr std::array<std::string_view, kPropKinds> kNames = {"roof", "vehicle", "rock", "autumn", "fog"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::vector<Prop> DrawProps(const world::Scene& scene, const PerceptionConfig& perception, std::uint64_t seed,
                            std::uint32_t scenario) {
  std::vector<Prop> props;
  const auto distractors = DrawDistractors(scene, perception, seed, scenario);
  for (std::size_t i = 0; i < distractors.size(); ++i) {
    // A stream for each: how one looks does not depend on how many there are.
    Stream stream(seed, scenario, Purpose::kAmbience, static_cast<std::uint32_t>(i) + 1);
    Prop prop;
    const Eigen::Vector3d& at_m = distractors[i].position_m;
    prop.kind = static_cast<PropKind>(stream.Below(kPropKinds));
    prop.position_m = {static_cast<float>(at_m.x()), static_cast<float>(at_m.y()),
                       static_cast<float>(scene.Ground().HeightAt(at_m.x(), at_m.y()))};
    const double yaw_rad = stream.Uniform(0.0, 2.0 * std::numbers::pi);
    prop.cos_yaw = static_cast<float>(std::cos(yaw_rad));
    prop.sin_yaw = static_cast<float>(std::sin(yaw_rad));
    Shape(prop, static_cast<float>(distractors[i].radius_m), stream);
    props.push_back(prop);
  }
  return props;
}

bool MeetsProp(const Prop& prop, const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction,
               PropHit& hit) {
  const Eigen::Vector3f& half = prop.half_size_m;
  ConvexCut body(Turned(prop, origin_m - prop.position_m), Turned(prop, direction));
  body.Cut({1, 0, 0}, half.x(), false);
  body.Cut({-1, 0, 0}, half.x(), false);
  body.Cut({0, 1, 0}, half.y(), false);
  body.Cut({0, -1, 0}, half.y(), false);
  body.Cut({0, 0, -1}, 1.5f, false);  // a foundation, for slopes
  if (prop.kind == PropKind::kRoof) {
    const float wall_m = 2.0f * half.z();
    const Eigen::Vector2f slope = Eigen::Vector2f(kRoofPitch, 1.0f).normalized();
    const float offset = slope.x() * half.y() + slope.y() * wall_m;
    body.Cut({0, slope.x(), slope.y()}, offset, true);
    body.Cut({0, -slope.x(), slope.y()}, offset, true);
  } else {
    body.Cut({0, 0, 1}, 2.0f * half.z(), true);
  }
  if (!body.Hit(hit)) return false;
  hit.normal = TurnedBack(prop, hit.normal);
  return true;
}

float FogDepth(const Prop& fog, const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction,
               float end_m) {
  // Stretched upright the bank is a ball of radius 1 around the origin, its density 1 - r^2: the integral along a
  // ray is a polynomial.
  const Eigen::Vector3f squeeze(1.0f / fog.radius_m, 1.0f / fog.radius_m,
                                1.0f / (kFogFlatness * fog.radius_m));
  const Eigen::Vector3f o = (origin_m - fog.position_m).cwiseProduct(squeeze);
  const Eigen::Vector3f d = direction.cwiseProduct(squeeze);
  const float a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1.0f;
  const float discriminant = b * b - a * c;
  if (discriminant <= 0.0f) return 0.0f;
  const float root = std::sqrt(discriminant);
  const float from = std::max(0.0f, (-b - root) / a), to = std::min(end_m, (-b + root) / a);
  if (to <= from) return 0.0f;
  const auto integral = [&](float t) { return -t * (c + t * (b + t * a / 3.0f)); };
  constexpr float kThickness = 1.3f;  // a ray through the middle sees 4/3 of it
  return kThickness * (integral(to) - integral(from)) / fog.radius_m;
}

}  // namespace ed3r::perception
