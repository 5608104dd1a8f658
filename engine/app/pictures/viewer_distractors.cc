#include "engine/app/pictures/viewer_distractors.h"

#include <vector>

#include "engine/perception/view.h"
#include "studies/figures/mission_columns.h"

namespace ed3r::app {
namespace {

using perception::Distractor;

robot::Pose PoseAfter(const mission::TimestepRecord& step) {
  robot::Pose pose;
  pose.position_m = {step.x_m, step.y_m, step.z_m};
  pose.yaw_rad = step.yaw_rad;
  pose.tilt_rad = step.tilt_rad;
  return pose;
}

// Index among all, -1 where none is in view.
int Strongest(const perception::FireView& fire, const robot::Pose& pose, const Config& config,
              const std::vector<Distractor>& all) {
  const auto share = [&](const std::vector<Distractor>& some) {
    return fire.Look(pose, config.sensing, config.perception, some).distractor_share;
  };
  const double most = share(all);
  if (most <= 0.0) return -1;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (share({all[i]}) >= most) return static_cast<int>(i);
  return -1;
}

}  // namespace

nlohmann::ordered_json ViewerDistractors(const mission::MissionTask& task,
                                         const mission::MissionRecord& record) {
  if (task.pixels != nullptr) return nullptr;
  const std::vector<Distractor> all =
      perception::DrawDistractors(task.scene, task.config.perception, task.seed, task.scenario);
  const perception::FireView fire(task.scene, static_cast<int>(record.site));
  nlohmann::ordered_json json = {{"places", nlohmann::ordered_json::array()},
                                 {"strongest", nlohmann::ordered_json::array()}};
  for (const Distractor& distractor : all)
    json["places"].push_back(
        {figures::Rounded(distractor.position_m.x(), 1), figures::Rounded(distractor.position_m.y(), 1),
         figures::Rounded(distractor.position_m.z(), 1), figures::Rounded(distractor.radius_m, 1)});
  for (const mission::TimestepRecord& step : record.steps)
    json["strongest"].push_back(Strongest(fire, PoseAfter(step), task.config, all));
  return json;
}

}  // namespace ed3r::app
