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
  constexpr std::array kNames = {std::pair{"NextStep", schedule::Autoreset::kNextStep},
                                 std::pair{"SameStep", schedule::Autoreset::kSameStep},
                                 std::pair{"Disabled", schedule::Autoreset::kDisabled}};
  for (const auto& [known, mode] : kNames)
    if (name == known) return mode;
  throw UserError(
      fmt::format("autoreset_mode: '{}' is not allowed; allowed: NextStep | SameStep | Disabled", name));
}

RowMissions MissionsOf(std::uint64_t seed, std::size_t row, std::size_t rows) {
  return {seed, static_cast<std::int64_t>(row), static_cast<std::int64_t>(rows)};
}

}  // namespace

void FleetHandle::Reset(std::span<const std::uint8_t> mask, std::optional<std::uint64_t> seed) {
  ED3R_CHECK(rows != nullptr, "missions of a sweep begin by themselves");
  if (!seed) return fleet->Reset(mask);
  for (std::size_t row = 0; row < rows->size(); ++row)
    if (mask.empty() || mask[row] != 0) (*rows)[row] = MissionsOf(*seed, row, rows->size());
  fleet->Reset(mask, std::vector<std::uint8_t>(rows->size(), 1));
}

void FleetHandle::ResetEach(std::span<const std::uint8_t> mask,
                            std::span<const std::optional<std::uint64_t>> seeds) {
  ED3R_CHECK(rows != nullptr, "missions of a sweep begin by themselves");
  ED3R_CHECK(seeds.size() == rows->size(), "seeds of another number");
  std::vector<std::uint8_t> from_first(rows->size());
  for (std::size_t row = 0; row < rows->size(); ++row) {
    if (!seeds[row] || (!mask.empty() && mask[row] == 0)) continue;
    (*rows)[row] = {.seed = *seeds[row]};
    from_first[row] = 1;
  }
  fleet->Reset(mask, from_first);
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
  handle->plan = std::make_shared<const sweep::SweepPlan>(PlanOfArm(LoadRequest(request), arm));
  handle->inputs = std::make_shared<const schedule::Inputs>(*handle->plan);
  const sweep::Arm& flown = handle->plan->stages.front().arms.front();
  handle->arm = flown.name;
  handle->config = flown.config;
  handle->rows = std::make_shared<std::vector<RowMissions>>();
  for (std::size_t row = 0; row < rows; ++row)
    handle->rows->push_back(MissionsOf(handle->plan->seed, row, rows));
  const auto task = [plan = handle->plan, inputs = handle->inputs, of = handle->rows](std::size_t row,
                                                                                      std::int64_t nth) {
    const RowMissions& missions = (*of)[row];
    const sweep::RunId id{0, 0, static_cast<int>(missions.first + nth * missions.stride)};
    mission::MissionTask next = schedule::TaskOf(*plan, *inputs, nullptr, id);
    next.seed = missions.seed;
    return std::optional(next);
  };
  handle->fleet = std::make_shared<schedule::Fleet>(rows, task, threads, mode);
  return handle;
}

}  // namespace ed3r::python
