#include "engine/store/layout.h"

#include <fmt/format.h>

#include "engine/core/check.h"

namespace ed3r::store {

std::int64_t RunLayout::Missions() const {
  std::int64_t missions = 0;
  for (const Stage& stage : stages) missions += stage.missions * static_cast<std::int64_t>(stage.arms.size());
  return missions;
}

std::int64_t RunLayout::RunIndex(int stage, int arm) const {
  ED3R_CHECK(stage >= 0 && stage < static_cast<int>(stages.size()) && arm >= 0 &&
                 arm < static_cast<int>(stages[stage].arms.size()),
             fmt::format("{}/{}", stage, arm));
  std::int64_t run = arm;
  for (int s = 0; s < stage; ++s) run += static_cast<std::int64_t>(stages[s].arms.size());
  return run;
}

std::int64_t RunLayout::RunIndex(const sweep::RunId& id) const {
  ED3R_CHECK(Contains(id), fmt::format("{}/{}/{}", id.stage, id.arm, id.mission));
  return RunIndex(id.stage, id.arm);
}

std::int64_t RunLayout::LinearIndex(const sweep::RunId& id) const {
  ED3R_CHECK(Contains(id), fmt::format("{}/{}/{}", id.stage, id.arm, id.mission));
  std::int64_t index = id.arm * stages[id.stage].missions + id.mission;
  for (int s = 0; s < id.stage; ++s)
    index += stages[s].missions * static_cast<std::int64_t>(stages[s].arms.size());
  return index;
}

bool RunLayout::Contains(const sweep::RunId& id) const {
  return id.stage >= 0 && id.stage < static_cast<int>(stages.size()) && id.arm >= 0 &&
         id.arm < static_cast<int>(stages[id.stage].arms.size()) && id.mission >= 0 &&
         id.mission < stages[id.stage].missions;
}

std::int64_t RunLayout::Scenario(const sweep::RunId& id) const {
  ED3R_CHECK(Contains(id), fmt::format("{}/{}/{}", id.stage, id.arm, id.mission));
  return stages[id.stage].arms[id.arm].first_scenario + id.mission;
}

std::optional<sweep::RunId> RunLayout::Place(std::int64_t run, std::int64_t mission) const {
  std::int64_t first = 0;
  for (std::size_t s = 0; s < stages.size(); ++s) {
    const auto arms = static_cast<std::int64_t>(stages[s].arms.size());
    if (run >= first && run < first + arms && mission >= 0 && mission < stages[s].missions)
      return sweep::RunId{static_cast<int>(s), static_cast<int>(run - first), static_cast<int>(mission)};
    first += arms;
  }
  return std::nullopt;
}

std::string RunLayout::DescribeKeys(std::int64_t run, std::int64_t mission) const {
  std::int64_t first = 0;
  for (const Stage& stage : stages) {
    const auto arms = static_cast<std::int64_t>(stage.arms.size());
    if (run >= first && run < first + arms)
      return fmt::format("stage {}, arm {}, mission {}", stage.name,
                         stage.arms[static_cast<std::size_t>(run - first)].name, mission);
    first += arms;
  }
  return fmt::format("run {}, mission {}", run, mission);
}

std::string RunLayout::Describe(const sweep::RunId& id) const {
  ED3R_CHECK(Contains(id), fmt::format("{}/{}/{}", id.stage, id.arm, id.mission));
  const Stage& stage = stages[id.stage];
  return fmt::format("stage {}, arm {}, mission {}", stage.name, stage.arms[id.arm].name, id.mission);
}

RunLayout LayoutOf(const sweep::SweepPlan& plan) {
  RunLayout layout{.name = plan.name, .seed = plan.seed, .stages = {}};
  for (const sweep::Stage& stage : plan.stages) {
    RunLayout::Stage& shape = layout.stages.emplace_back();
    shape.name = stage.name;
    shape.missions = stage.missions;
    for (const sweep::Arm& arm : stage.arms)
      shape.arms.push_back({arm.name, arm.config.mission.first_scenario});
  }
  return layout;
}

}  // namespace ed3r::store
