#include "engine/python/sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "engine/agents/strategy.h"
#include "engine/core/check.h"
#include "engine/mission/invariants.h"
#include "engine/python/aside.h"
#include "engine/python/fleets.h"
#include "engine/schedule/sweep_runner.h"
#include "engine/sweep/sweep_file.h"
#include "studies/metrics/definitions.h"
#include "studies/report/load.h"

namespace ed3r::python {
namespace {

std::map<std::string, std::string> NotesOf(const SweepRequest& request, const FlightPlace& place) {
  return {{"sweep file", std::filesystem::absolute(request.file).lexically_normal().string()},
          {"sweep --set", fmt::format("{}", fmt::join(request.settings, "\n"))},
          {"sweep --seed", request.seed ? fmt::format("{}", *request.seed) : ""},
          {"sweep --missions", request.missions ? fmt::format("{}", *request.missions) : ""},
          {"policy", place.policy_identity}};
}

// Missions of `todo`, row by row, as a fleet; each that has ended is offered.
std::shared_ptr<FleetHandle> FleetOf(const sweep::SweepPlan& plan, const schedule::Inputs& inputs,
                                     const sweep::Arm& arm, const std::vector<sweep::RunId>& todo,
                                     const FlightPlace& place, const schedule::OfferFn& offer,
                                     const std::atomic<bool>& stop) {
  const std::size_t rows = std::min(place.rows, todo.size());
  auto handle = std::make_shared<FleetHandle>();
  handle->arm = arm.name;
  handle->config = arm.config;
  handle->stop = &stop;
  const auto task = [&plan, &inputs, &todo, rows](std::size_t row, std::int64_t nth) {
    const std::size_t at = row + static_cast<std::size_t>(nth) * rows;
    return at < todo.size() ? std::optional(schedule::TaskOf(plan, inputs, nullptr, todo[at])) : std::nullopt;
  };
  handle->fleet =
      std::make_shared<schedule::Fleet>(rows, task, place.threads, schedule::Autoreset::kSameStep);
  handle->fleet->OnRecord([&offer, id = todo.front()](const mission::MissionTask& flown,
                                                      std::optional<mission::MissionRecord> record) {
    const bool ended = record.has_value();
    store::Failure failure;
    if (!ended) failure = {std::string(NameOf(mission::Invariant::kMissionEnds)), "the mission does not end"};
    offer({id.stage, id.arm, flown.mission}, std::move(record), std::move(failure));
  });
  return handle;
}

}  // namespace

sweep::SweepPlan LoadRequest(const SweepRequest& request) {
  sweep::SweepOverrides overrides;
  overrides.set = request.settings;
  overrides.seed = request.seed;
  if (request.missions) {
    if (*request.missions < 1)
      throw UserError(fmt::format("missions: {} is not allowed; allowed: 1 .. {}", *request.missions,
                                  sweep::kMaxMissions));
    overrides.missions.push_back({"", *request.missions});
  }
  return sweep::LoadSweep(request.file, overrides, [](const std::string& key, const std::string& value) {
    if (key == "precision.metric") return metrics::CheckMetricName(value);
    return key == "mission.strategy" ? agents::CheckStrategyName(value) : std::string();
  });
}

std::vector<std::string> OutsideArms(const sweep::SweepPlan& plan) {
  std::vector<std::string> names;
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      if (arm.config.mission.strategy == agents::kOutsideStrategy &&
          std::find(names.begin(), names.end(), arm.name) == names.end())
        names.push_back(arm.name);
  return names;
}

namespace {

// What of FlyWithPolicy is done beside the calling thread, which drives.
FlightCount FlyAside(const SweepRequest& request, const FlightPlace& place, const DriveFn& drive,
                     Aside& aside) {
  const sweep::SweepPlan plan = LoadRequest(request);
  const schedule::Inputs inputs(plan);
  schedule::SweepOptions options;
  options.dir = place.out;
  options.cache_dir = place.cache;
  options.schedule.threads = place.threads;
  options.schedule.quiet = true;
  options.schedule.stop = &aside.stop();
  options.half_width = report::HalfWidth;
  options.notes = NotesOf(request, place);
  options.outside_identity = place.policy_identity;
  options.outside = [&](const sweep::Arm& arm, const std::vector<sweep::RunId>& todo,
                        const schedule::OfferFn& offer, const std::atomic<bool>& stop) {
    const std::shared_ptr<FleetHandle> fleet = FleetOf(plan, inputs, arm, todo, place, offer, stop);
    // Python may hold the fleet's arrays for longer than the plan lives.
    struct Retire {
      FleetHandle& handle;
      ~Retire() { handle.fleet->Retire(), handle.stop = nullptr; }
    } const retire{*fleet};
    fleet->fleet->Reset();
    aside.Call([&] { drive(fleet); });
  };
  const schedule::SweepSummary summary = schedule::RunSweep(plan, inputs, options);
  return {summary.flown.stored, summary.flown.failed};
}

}  // namespace

FlightCount FlyWithPolicy(const SweepRequest& request, const FlightPlace& place, const DriveFn& drive,
                          const std::function<void()>& heed) {
  if (place.rows < 1) throw UserError("num_envs: 0 is not allowed; allowed: 1 or more");
  Aside aside(heed);
  FlightCount count;
  aside.Run([&] { count = FlyAside(request, place, drive, aside); });
  return count;
}

}  // namespace ed3r::python
