// What the LiDARs of a flown mission met, for its viewer.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/config/config.h"
#include "engine/robot/flight.h"
#include "engine/robot/lidar.h"
#include "engine/world/scene.h"

namespace ed3r::app {

class ShortRays {
 public:
  // The scene must outlive this.
  ShortRays(const world::Scene& scene, const Config& config);

  // Appends [at, x_m, y_m, z_m, ahead] for each surface within range: the point, in the world, that a LiDAR's middle ray
  // meets (six, along the axes of the yaw-stabilised body; ahead 0), and, in motion, the point as far along it as the first
  // surface in the tube that the safety rule looks at (ahead 1).
  void Add(std::size_t at, const robot::TraceSample& sample, nlohmann::ordered_json& list) const;

 private:
  const world::Scene& scene_;
  double range_m_;
  robot::LidarBundle tube_;
};

}  // namespace ed3r::app
