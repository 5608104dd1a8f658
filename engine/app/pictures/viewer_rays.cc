#include "engine/app/pictures/viewer_rays.h"

#include <cmath>

#include "engine/robot/airframe.h"
#include "studies/figures/mission_columns.h"

namespace ed3r::app {
namespace {

constexpr double kInMotionMps = 0.3;

}  // namespace

ShortRays::ShortRays(const world::Scene& scene, const Config& config)
    : scene_(scene),
      range_m_(config.sensing.lidar_range_m),
      tube_(scene.Geometry(),
            robot::Airframe(config).BoundingRadiusM() + robot::TubeMarginM(config.environment),
            config.sensing.lidar_range_m) {}

void ShortRays::Add(std::size_t at, const robot::TraceSample& sample, nlohmann::ordered_json& list) const {
  const auto add = [&](const Eigen::Vector3d& direction, double distance_m, bool ahead) {
    if (!std::isfinite(distance_m)) return;
    const Eigen::Vector3d met_m = sample.position_m + distance_m * direction;
    list.push_back({at, figures::Rounded(met_m.x(), 1), figures::Rounded(met_m.y(), 1),
                    figures::Rounded(met_m.z(), 1), ahead ? 1 : 0});
  };
  const Eigen::Vector3d forward(std::cos(sample.yaw_rad), std::sin(sample.yaw_rad), 0.0);
  const Eigen::Vector3d left(-forward.y(), forward.x(), 0.0);
  for (const Eigen::Vector3d& axis : {forward, left, Eigen::Vector3d(0.0, 0.0, 1.0)})
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d direction = sign * axis;
      add(direction, scene_.Geometry().Distance(sample.position_m, direction, range_m_), false);
    }
  const double speed_mps = sample.velocity_mps.norm();
  if (speed_mps < kInMotionMps) return;
  const Eigen::Vector3d direction = sample.velocity_mps / speed_mps;
  add(direction, tube_.FreeDistance(sample.position_m, direction), true);
}

}  // namespace ed3r::app
