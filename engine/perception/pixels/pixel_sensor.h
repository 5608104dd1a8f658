// The pixel tier (perception.tier pixels): every timestep renders the camera's frames and asks a real network about each.
#pragma once

#include <memory>
#include <string>

#include "engine/perception/render/renderer.h"
#include "engine/perception/sensor.h"
#include "engine/perception/vision/frame_detector.h"

namespace ed3r::perception {

// What all missions on one scene with one pair of detectors share, read-only. Threads: any number.
struct PixelTier {
  std::shared_ptr<const TraceScene> scene;
  DetectorPair detectors;
};

// Only the model that the robot or the RC runs looks at the frames; the frames are the same for either. Tier and config
// must outlive the sensor.
std::unique_ptr<Sensor> MakePixelSensor(const PixelTier& tier, const Config& config,
                                        const SensorScenario& scenario);

// PNG files of what the camera saw in one timestep, each frame with the confidences of both models: STEM_frames.png and
// STEM_large.png. Throws UserError when they cannot be written.
void WriteSensingPictures(const PixelTier& tier, const Config& config, const SensorScenario& scenario,
                          const robot::Pose& pose, std::uint32_t timestep, const std::string& stem);

}  // namespace ed3r::perception
