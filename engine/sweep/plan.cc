#include "engine/sweep/plan.h"

#include <fmt/format.h>

#include "engine/config/parameters.h"
#include "engine/core/check.h"

namespace ed3r::sweep {

Config Arm::CanonicalConfig() const {
  Config canonical = config;
  for (const auto& [key, path] : files) {
    const std::string problem = SetParameter(canonical, key, path);
    ED3R_CHECK(problem.empty(), problem);
  }
  return canonical;
}

std::int64_t SweepPlan::Missions() const {
  std::int64_t sum = 0;
  for (const Stage& stage : stages) sum += static_cast<std::int64_t>(stage.arms.size()) * stage.missions;
  return sum;
}

std::string SweepPlan::CanonicalText() const {
  std::string text = fmt::format("sweep={}\nseed={}\n", name, seed);
  for (const Stage& stage : stages) {
    text += fmt::format("stage={}\nkind={}\nafter={}\nmissions={}\n", stage.name,
                        stage.kind == StageKind::kFly ? "fly" : "train", fmt::join(stage.after, ","),
                        stage.missions);
    if (stage.precision)
      text += fmt::format("precision={} {} {}\n", stage.precision->metric, stage.precision->half_width,
                          stage.precision->every);
    if (stage.timesteps != KeptTimesteps::kAll)
      text += fmt::format("timesteps={}\n", NameOf(stage.timesteps));
    for (const Arm& arm : stage.arms) {
      text += fmt::format("arm={}\n", arm.name) + ed3r::CanonicalText(arm.CanonicalConfig());
    }
  }
  return text;
}

}  // namespace ed3r::sweep
