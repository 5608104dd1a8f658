#include "engine/python/fleets.h"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <utility>

#include "engine/agents/strategy.h"
#include "engine/core/check.h"
#include "engine/core/suggest.h"
#include "engine/schedule/sweep_runner.h"

namespace ed3r::python {
namespace {

constexpr std::size_t kMostRows = 1'000'000;

// The plan of the one arm alone, in a stage of its own that waits for nothing, with its decisions from outside.
sweep::SweepPlan PlanOfArm(sweep::SweepPlan plan, const std::string& name) {
  std::vector<std::string> names;
  std::optional<sweep::Stage> found;
  int matches = 0;
  for (const sweep::Stage& stage : plan.stages) {
    if (stage.kind != sweep::StageKind::kFly) continue;
    for (const sweep::Arm& arm : stage.arms) {
      names.push_back(arm.name);
      if (!name.empty() && name != arm.name && name != stage.name + "/" + arm.name) continue;
      ++matches;
      found.emplace();
      found->name = stage.name;
      found->missions = stage.missions;
      found->arms = {arm};
    }
  }
  if (matches != 1) {
    const std::string nearest = name.empty() || matches > 1 ? "" : NearestWord(name, names);
    throw UserError(fmt::format("{}: arm: '{}' {}; allowed: {}{}", plan.file, name,
                                matches == 0 ? "is not in the sweep" : "is not the only one",
                                fmt::join(names, " | "),
                                nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }
  found->arms.front().config.mission.strategy = agents::kOutsideStrategy;
  plan.stages = {std::move(*found)};
  return plan;
}

schedule::Autoreset AutoresetNamed(const std::string& name) {
  constexpr std::array kNames = {std::pair{"next_step", schedule::Autoreset::kNextStep},
                                 std::pair{"same_step", schedule::Autoreset::kSameStep},
                                 std::pair{"disabled", schedule::Autoreset::kDisabled}};
  for (const auto& [known, mode] : kNames)
    if (name == known) return mode;
  throw UserError(
      fmt::format("autoreset_mode: '{}' is not allowed; allowed: next_step | same_step | disabled", name));
}

}  // namespace

void FleetHandle::Reset(std::span<const std::uint8_t> mask, std::optional<std::uint64_t> seed) {
  ED3R_CHECK(plan != nullptr, "missions of a sweep begin by themselves");
  if (seed) plan->seed = *seed;
  fleet->Reset(mask, seed.has_value());
}

std::vector<double> FleetHandle::LargestCommand() const {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const double axis_m = config.agents.axis_range_m;
  return {axis_m, axis_m, axis_m, config.agents.yaw_range_deg * kDegree,
          config.agents.tilt_range_deg * kDegree};
}

std::shared_ptr<FleetHandle> MakeFleet(const SweepRequest& request, const std::string& arm, std::size_t rows,
                                       int threads, const std::string& autoreset) {
  if (rows < 1 || rows > kMostRows)
    throw UserError(fmt::format("num_envs: {} is not allowed; allowed: 1 .. {}", rows, kMostRows));
  const schedule::Autoreset mode = AutoresetNamed(autoreset);
  auto handle = std::make_shared<FleetHandle>();
  handle->plan = std::make_shared<sweep::SweepPlan>(PlanOfArm(LoadRequest(request), arm));
  handle->inputs = std::make_shared<const schedule::Inputs>(*handle->plan);
  const sweep::Arm& flown = handle->plan->stages.front().arms.front();
  handle->arm = flown.name;
  handle->config = flown.config;
  const auto task = [plan = handle->plan, inputs = handle->inputs, rows](std::size_t row, std::int64_t nth) {
    const sweep::RunId id{
        0, 0, static_cast<int>(static_cast<std::int64_t>(row) + nth * static_cast<std::int64_t>(rows))};
    return std::optional(schedule::TaskOf(*plan, *inputs, nullptr, id));
  };
  handle->fleet = std::make_shared<schedule::Fleet>(rows, task, threads, mode);
  return handle;
}

}  // namespace ed3r::python
