// What a detector can take for fire, as things that the camera sees (R34): at the places of the fast tier's
// distractors, with a kind drawn per mission.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/config/perception.h"
#include "engine/perception/render/light.h"
#include "engine/world/scene.h"

namespace ed3r::perception {

enum class PropKind : std::uint8_t { kRoof, kVehicle, kRock, kAutumn, kFog };
inline constexpr int kPropKinds = 5;
std::string_view NameOf(PropKind kind);

struct Prop {
  PropKind kind = PropKind::kRock;
  Eigen::Vector3f position_m;  // on the ground
  float radius_m = 0.0f;  // of the patch, the grove or the fog bank; of the circle around a roof or vehicle
  float cos_yaw = 1.0f, sin_yaw = 0.0f;
  Eigen::Vector3f half_size_m = Eigen::Vector3f::Zero();  // solid kinds: the box
  Colour colour;

  bool Solid() const { return kind == PropKind::kRoof || kind == PropKind::kVehicle; }
};

// Where a ray meets a solid prop.
struct PropHit {
  float distance_m = 0.0f;
  Eigen::Vector3f normal;
  bool top = false;  // on the roof rather than a wall
};

std::vector<Prop> DrawProps(const world::Scene& scene, const PerceptionConfig& perception, std::uint64_t seed,
                            std::uint32_t scenario);

// A house has a gable roof over its box, a vehicle is a box. False where the ray passes by.
bool MeetsProp(const Prop& prop, const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction,
               PropHit& hit);

// Optical depth of a fog bank, a flattened ball of mist, along a ray up to a distance.
float FogDepth(const Prop& fog, const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction,
               float end_m);

}  // namespace ed3r::perception
