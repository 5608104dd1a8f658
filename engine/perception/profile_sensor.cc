#include "engine/perception/detector.h"
#include "engine/perception/sensor.h"
#include "engine/perception/view.h"

namespace ed3r::perception {
namespace {

class ProfileSensor : public Sensor {
 public:
  ProfileSensor(const world::Scene& scene, const Config& config, const SensorScenario& scenario)
      : config_(config),
        scenario_(scenario),
        fire_(scene, scenario.site),
        distractors_(DrawDistractors(scene, config.perception, scenario.seed, scenario.number)) {}

  Detection Sense(const robot::Pose& pose, DetectionModel model, std::uint32_t timestep,
                  std::uint32_t view_begin) const override {
    const View view = fire_.Look(pose, config_.sensing, config_.perception, distractors_);
    View without_distractors = view;
    without_distractors.distractor_share = 0.0;
    const LookDraws draws{scenario_.seed, scenario_.number, timestep,
                          config_.perception.view_noise == ViewNoise::kKept ? view_begin : timestep};
    const auto score = [&](const View& seen) {
      return DetectFromProfile(seen, config_.perception, model, config_.sensing.Frames(), draws);
    };
    Detection detection{.score = score(view),
                        .fire_share = view.fire_share,
                        .smoke_share = view.smoke_share,
                        .fire_in_view = view.fire_in_view};
    detection.fire_only_scs =
        view.distractor_share > 0.0 ? score(without_distractors).scs : detection.score.scs;
    return detection;
  }

 private:
  const Config& config_;
  const SensorScenario scenario_;
  const FireView fire_;
  const std::vector<Distractor> distractors_;
};

}  // namespace

std::unique_ptr<Sensor> MakeProfileSensor(const world::Scene& scene, const Config& config,
                                          const SensorScenario& scenario) {
  return std::make_unique<ProfileSensor>(scene, config, scenario);
}

}  // namespace ed3r::perception
