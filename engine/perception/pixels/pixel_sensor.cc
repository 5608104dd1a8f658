#include "engine/perception/pixels/pixel_sensor.h"

#include <fmt/format.h>

#include <vector>

#include "engine/perception/render/pictures.h"

namespace ed3r::perception {
namespace {

Renderer RendererOf(const PixelTier& tier, const Config& config, const SensorScenario& scenario) {
  return {tier.scene, scenario.site, config.perception, config.sensing, scenario.seed, scenario.number};
}

std::vector<double> Confidences(const FrameDetector& detector, const FrameStack& frames) {
  std::vector<double> confidences(static_cast<std::size_t>(frames.frames));
  detector.Confidences(frames, confidences);
  return confidences;
}

class PixelSensor : public Sensor {
 public:
  PixelSensor(const PixelTier& tier, const Config& config, const SensorScenario& scenario)
      : detectors_(tier.detectors),
        frame_threshold_(config.perception.frame_threshold),
        renderer_(RendererOf(tier, config, scenario)) {}

  Detection Sense(const robot::Pose& pose, DetectionModel model, std::uint32_t timestep,
                  std::uint32_t /*view*/) const override {
    const SensingFrames seen = renderer_.Sense(pose, timestep);
    const FrameDetector& detector = model == DetectionModel::kFull ? *detectors_.full : *detectors_.quantized;
    const double pixels = static_cast<double>(seen.frames.width_px) * seen.frames.height_px;
    const Score score = StableConfidence(Confidences(detector, seen.frames), frame_threshold_);
    return {.score = score,
            .fire_only_scs = seen.truth.FireInView() ? score.scs : 0.0,
            .fire_share = seen.truth.fire_px / pixels,
            .smoke_share = seen.truth.smoke_px / pixels,
            .fire_in_view = seen.truth.FireInView()};
  }

 private:
  const DetectorPair& detectors_;
  const double frame_threshold_;
  const Renderer renderer_;
};

}  // namespace

std::unique_ptr<Sensor> MakePixelSensor(const PixelTier& tier, const Config& config,
                                        const SensorScenario& scenario) {
  return std::make_unique<PixelSensor>(tier, config, scenario);
}

void WriteSensingPictures(const PixelTier& tier, const Config& config, const SensorScenario& scenario,
                          const robot::Pose& pose, std::uint32_t timestep, const std::string& stem) {
  const Renderer renderer = RendererOf(tier, config, scenario);
  const FrameStack frames = renderer.Sense(pose, timestep).frames;
  const std::vector<double> full = Confidences(*tier.detectors.full, frames);
  const std::vector<double> quantized = Confidences(*tier.detectors.quantized, frames);
  std::vector<std::string> captions;
  for (std::size_t i = 0; i < full.size(); ++i)
    captions.push_back(fmt::format("F {:.2f}  Q {:.2f}", full[i], quantized[i]));
  WriteFramePictures(renderer, pose, timestep, captions, stem);
}

}  // namespace ed3r::perception
