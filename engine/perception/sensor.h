// The camera and the detection models of one mission, whichever tier looks (perception.tier).
#pragma once

#include <cstdint>
#include <memory>

#include "engine/config/config.h"
#include "engine/perception/score.h"
#include "engine/robot/motion.h"
#include "engine/world/scene.h"

namespace ed3r::perception {

enum class DetectionModel { kFull, kQuantized };

// What one sensing period told, and the truth about it.
struct Detection {
  Score score;
  double fire_only_scs = 0.0;  // what flame and smoke in view would have reached without distractors (R16)
  double fire_share = 0.0;     // visible flame as a share of the image
  double smoke_share = 0.0;    // visible smoke likewise
  bool fire_in_view = false;   // R16
};

// Threads: one mission, one thread. Deterministic in what it was made from and the arguments: a timestep's draws do not
// depend on the timesteps before it, and both models meet the same view.
class Sensor {
 public:
  virtual ~Sensor() = default;
  // `view`: the timestep in which the robot came to this pose; later ones hover over the same view.
  virtual Detection Sense(const robot::Pose& pose, DetectionModel model, std::uint32_t timestep,
                          std::uint32_t view) const = 0;
};

// The fire that burns in a mission, and the keys of its draws.
struct SensorScenario {
  int site = 0;
  std::uint64_t seed = 0;
  std::uint32_t number = 0;
};

// Confidences from geometry (perception.tier profile). Scene and config must outlive the sensor.
std::unique_ptr<Sensor> MakeProfileSensor(const world::Scene& scene, const Config& config,
                                          const SensorScenario& scenario);

}  // namespace ed3r::perception
