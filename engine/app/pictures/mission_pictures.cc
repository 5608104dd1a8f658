#include "engine/app/pictures/mission_pictures.h"

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "engine/perception/render/pictures.h"

namespace ed3r::app {
namespace {

// As WriteSensingPictures, with captions that do not pass for what the mission knew.
void WriteUnusedPictures(const perception::PixelTier& tier, const Config& config,
                         const perception::SensorScenario& scenario, const robot::Pose& pose,
                         std::uint32_t timestep, const std::string& stem) {
  const perception::Renderer renderer(tier.scene, scenario.site, config.perception, config.sensing,
                                      scenario.seed, scenario.number);
  const perception::FrameStack frames = renderer.Sense(pose, timestep).frames;
  std::vector<double> full(static_cast<std::size_t>(frames.frames)), quantized(full.size());
  tier.detectors.full->Confidences(frames, full);
  tier.detectors.quantized->Confidences(frames, quantized);
  std::vector<std::string> captions;
  for (std::size_t i = 0; i < full.size(); ++i)
    captions.push_back(fmt::format("F {:.2f}  Q {:.2f}  not the mission's", full[i], quantized[i]));
  perception::WriteFramePictures(renderer, pose, timestep, captions, stem);
}

}  // namespace

MissionPictures::MissionPictures(const mission::MissionTask& task) : task_(task) {
  if (!Looked())
    own_ = {std::make_shared<const perception::TraceScene>(task.scene),
            perception::LoadDetectors(task.config.perception.detector)};
}

std::string MissionPictures::Write(const mission::MissionRecord& flown, std::int64_t k,
                                   const std::string& stem) const {
  const perception::SensorScenario scenario{static_cast<int>(flown.site), task_.seed, task_.scenario};
  const mission::TimestepRecord& step = flown.steps[static_cast<std::size_t>(k - 1)];
  const robot::Pose pose{{step.x_m, step.y_m, step.z_m}, step.yaw_rad, step.tilt_rad};
  const auto timestep = static_cast<std::uint32_t>(k);
  std::string files = fmt::format("{0}_frames.png, {0}_large.png\n", stem);
  if (Looked()) {
    perception::WriteSensingPictures(*task_.pixels, task_.config, scenario, pose, timestep, stem);
    return files;
  }
  WriteUnusedPictures(own_, task_.config, scenario, pose, timestep, stem);
  return files +
         fmt::format(
             "  pictures only: this mission's confidences came from the profile tier: mean {:.3f}, sd "
             "{:.3f}, SCS {:.3f}\n",
             step.confidence_mean, step.confidence_sd, step.scs);
}

}  // namespace ed3r::app
