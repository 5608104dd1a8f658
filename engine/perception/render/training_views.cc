#include "engine/perception/render/training_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/perception/view.h"

namespace ed3r::perception {
namespace {

constexpr int kTries = 400;
constexpr double kRoomM = 2.0;  // free space around the robot (R24)
constexpr double kNearestM = 10.0, kFarthestM = 350.0, kFarthestDistractorM = 150.0;
constexpr double kLowestM = 3.0, kHighestM = 100.0;  // above ground
constexpr double kDegree = std::numbers::pi / 180.0;

// What a view is turned towards. As if fire: as a fire would be looked at, at the fire's site where it is hidden or at
// another one. Without such views a clearing, or ground and sky as far looks at fires have them, would tell of fire.
enum class Look { kFire, kAnywhere, kDistractor, kAsIfFire };
constexpr Look kLooksWithoutFire[] = {Look::kAnywhere, Look::kDistractor, Look::kAsIfFire};

Eigen::Vector3d FireMiddleM(const world::Scene& scene, int site) {
  return scene.Sites()[static_cast<std::size_t>(site)].base_m +
         Eigen::Vector3d(0, 0, 0.3 * scene.Fire().total_height_m);
}

bool HasRoom(const world::Scene& scene, const Eigen::Vector3d& at_m) {
  const Eigen::Vector3d& size_m = scene.SizeM();
  if ((at_m.array() < 0.0).any() || (at_m.array() > size_m.array()).any()) return false;
  if (at_m.z() < scene.Ground().HeightAt(at_m.x(), at_m.y()) + kLowestM) return false;
  const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                  Eigen::Vector3d::UnitZ()};
  for (const Eigen::Vector3d& axis : axes)
    for (const double sign : {1.0, -1.0})
      if (scene.Geometry().Distance(at_m, sign * axis, kRoomM) < kRoomM) return false;
  return true;
}

Eigen::Vector3d Anywhere(const world::Scene& scene, Stream& stream) {
  const double x_m = stream.Uniform(0.0, scene.SizeM().x()), y_m = stream.Uniform(0.0, scene.SizeM().y());
  return {x_m, y_m, scene.Ground().HeightAt(x_m, y_m) + stream.Uniform(kLowestM, kHighestM)};
}

// At a distance whose logarithm is uniform: looks from near are as many as looks from far.
Eigen::Vector3d Around(const world::Scene& scene, const Eigen::Vector3d& target_m, double nearest_m,
                       double farthest_m, Stream& stream) {
  const double distance_m = std::exp(stream.Uniform(std::log(nearest_m), std::log(farthest_m)));
  const double azimuth_rad = stream.Uniform(0.0, 2.0 * std::numbers::pi);
  const double x_m = target_m.x() + distance_m * std::cos(azimuth_rad);
  const double y_m = target_m.y() + distance_m * std::sin(azimuth_rad);
  return {x_m, y_m, scene.Ground().HeightAt(x_m, y_m) + stream.Uniform(kLowestM, kHighestM)};
}

// Turns the camera so that the target lies somewhere in the frame, unless it is above a level camera's reach.
void Aim(robot::Pose& pose, const Eigen::Vector3d& target_m, Stream& stream) {
  const Eigen::Vector3d towards = target_m - pose.position_m;
  const double level_m = std::hypot(towards.x(), towards.y());
  pose.yaw_rad = std::atan2(towards.y(), towards.x()) + stream.Uniform(-36.0, 36.0) * kDegree;
  const double exact_rad = std::atan2(-towards.z(), level_m);
  const double tilt_rad = exact_rad + stream.Uniform(-22.0, 22.0) * kDegree;
  pose.tilt_rad = std::clamp(tilt_rad, 0.0, 90.0 * kDegree);
}

robot::Pose DrawPose(const world::Scene& scene, const Eigen::Vector3d* target_m, double nearest_m,
                     double farthest_m, Stream& stream) {
  robot::Pose pose;
  pose.position_m =
      target_m != nullptr ? Around(scene, *target_m, nearest_m, farthest_m, stream) : Anywhere(scene, stream);
  pose.yaw_rad = stream.Uniform(-std::numbers::pi, std::numbers::pi);
  pose.tilt_rad = stream.Uniform(0.0, 90.0) * kDegree;
  if (target_m != nullptr) Aim(pose, *target_m, stream);
  return pose;
}

}  // namespace

ViewPlan PlanView(std::span<const std::shared_ptr<const TraceScene>> scenes, const Config& config,
                  std::uint64_t seed, std::uint32_t number) {
  ED3R_CHECK(!scenes.empty(), "no world");
  Stream stream(seed, number, Purpose::kDataSet);
  ViewPlan plan;
  plan.world = static_cast<int>(stream.Below(static_cast<std::uint32_t>(scenes.size())));
  const world::Scene& scene = scenes[static_cast<std::size_t>(plan.world)]->World();
  ED3R_CHECK(!scene.Sites().empty(), "a world without fire sites");
  plan.site = static_cast<int>(stream.Below(static_cast<std::uint32_t>(scene.Sites().size())));
  const Look look = number % 2 == 0 ? Look::kFire : kLooksWithoutFire[stream.Below(3)];
  const auto distractors = DrawDistractors(scene, config.perception, seed, number);
  const FireView fire(scene, plan.site);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    Eigen::Vector3d target_m;
    bool aimed = true;
    if (look == Look::kFire) {
      target_m = FireMiddleM(scene, plan.site);
    } else if (look == Look::kAsIfFire && attempt < kTries / 2) {  // where all sites lie in sight: anywhere
      target_m = FireMiddleM(
          scene, static_cast<int>(stream.Below(static_cast<std::uint32_t>(scene.Sites().size()))));
    } else if (look == Look::kDistractor && !distractors.empty()) {
      target_m = distractors[stream.Below(static_cast<std::uint32_t>(distractors.size()))].position_m;
    } else {
      aimed = false;
    }
    const double farthest_m = look == Look::kDistractor ? kFarthestDistractorM : kFarthestM;
    const robot::Pose pose = DrawPose(scene, aimed ? &target_m : nullptr, kNearestM, farthest_m, stream);
    if (!HasRoom(scene, pose.position_m)) continue;
    plan.pose = pose;
    if (fire.Look(pose, config.sensing, config.perception, {}).fire_in_view == (look == Look::kFire))
      return plan;
  }
  ED3R_CHECK(HasRoom(scene, plan.pose.position_m), "a world in which a robot finds no room");
  return plan;
}

std::string PropsInView(const Renderer& renderer, const world::Scene& scene, const robot::Pose& pose,
                        const SensingConfig& sensing) {
  const Camera camera(pose, sensing);
  std::array<bool, kPropKinds> seen{};
  for (const Prop& prop : renderer.Props()) {
    const Eigen::Vector3d top_m = prop.position_m.cast<double>() + Eigen::Vector3d(0, 0, 2.0);
    if (camera.ShareOf(top_m, 1.0) <= 0.0 || (top_m - pose.position_m).norm() > kFarthestM) continue;
    if (!scene.Geometry().Occluded(pose.position_m, top_m)) seen[static_cast<std::size_t>(prop.kind)] = true;
  }
  std::string names;
  for (int kind = 0; kind < kPropKinds; ++kind)
    if (seen[static_cast<std::size_t>(kind)]) {
      if (!names.empty()) names += ';';
      names += NameOf(static_cast<PropKind>(kind));
    }
  return names;
}

}  // namespace ed3r::perception
