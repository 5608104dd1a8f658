// What stepping missions from outside costs beside the closed loop: the same missions of the rule look-level, flown by
// FlyMission, as 'ed3r run' does, and stepped by a Fleet of some rows that takes the same decisions.
//   build/bench/engine/schedule/fleet_bench SWEEP MISSIONS THREADS ROWS...
// The sweep's first arm gives world and parameters. One line per number of rows: decisions a second (two a timestep),
// simulated seconds a second, and the closed loop's time over the fleet's, by the clock and by processor time, which other
// programs on the machine disturb less. Both take turns three times, from kManyRows rows on once; the best of each counts.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "engine/agents/features.h"
#include "engine/agents/strategies/look_level.h"
#include "engine/core/check.h"
#include "engine/schedule/fleet.h"
#include "engine/schedule/inputs.h"
#include "engine/schedule/parallel_for.h"
#include "engine/schedule/sweep_runner.h"
#include "engine/sweep/sweep_file.h"

namespace ed3r::schedule {
namespace {

constexpr std::size_t kManyRows = 1024;

struct Flown {
  double wall_s = 0, cpu_s = 0, simulated_s = 0;
  std::int64_t timesteps = 0;
};

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

// Of all threads of this process.
double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

mission::MissionTask TaskFor(const world::Scene& scene, const Config& config, std::int64_t mission) {
  mission::MissionTask task{.scene = scene, .config = config};
  task.seed = 1;
  task.scenario = static_cast<std::uint32_t>(mission);
  task.mission = static_cast<int>(mission);
  return task;
}

Flown ClosedLoop(const world::Scene& scene, const Config& config, std::int64_t missions, int threads) {
  std::vector<mission::MissionRecord> records(static_cast<std::size_t>(missions));
  const double cpu_s = CpuSeconds();
  const auto begin = std::chrono::steady_clock::now();
  ParallelFor(threads, missions, [&](std::int64_t i) {
    records[static_cast<std::size_t>(i)] = mission::FlyMission(TaskFor(scene, config, i));
  });
  Flown flown{.wall_s = Seconds(begin), .cpu_s = CpuSeconds() - cpu_s};
  for (const mission::MissionRecord& record : records) {
    flown.simulated_s += record.duration_s;
    flown.timesteps += record.timesteps;
  }
  return flown;
}

// The view that a row of the fleet shows.
agents::RcView ViewOf(const float* seen) {
  agents::RcView view;
  view.pose = {
      {seen[rfnn::kRcX], seen[rfnn::kRcY], seen[rfnn::kRcZ]}, seen[rfnn::kRcYaw], seen[rfnn::kRcTilt]};
  view.previous_scs = seen[rfnn::kRcPreviousScs];
  return view;
}

Flown Stepped(const world::Scene& scene, const Config& config, std::int64_t missions, int threads,
              std::size_t rows) {
  std::vector<std::unique_ptr<agents::LookLevel>> rules(rows);
  const auto task = [&](std::size_t row, std::int64_t nth) -> std::optional<mission::MissionTask> {
    const auto mission = static_cast<std::int64_t>(row) + nth * static_cast<std::int64_t>(rows);
    if (mission >= missions) return std::nullopt;
    return TaskFor(scene, config, mission);
  };
  const agents::AgentContext context{config, agents::FindStrategy("look-level"), {}, scene.SizeM()};
  Fleet fleet(rows, task, threads, Autoreset::kSameStep);
  Flown flown;
  fleet.OnRecord([&](const mission::MissionTask&, std::optional<mission::MissionRecord> record) {
    flown.simulated_s += record->duration_s;
    flown.timesteps += record->timesteps;
  });
  std::vector<float> commands(rows * kCommandValues);
  const std::vector<std::int64_t> executions(rows, static_cast<std::int64_t>(agents::Execution::kQuantized));
  const double cpu_s = CpuSeconds();
  const auto begin = std::chrono::steady_clock::now();
  fleet.Reset();
  const FleetColumns& now = fleet.Now();
  while (std::any_of(now.mission.begin(), now.mission.end(), [](std::int64_t m) { return m >= 0; })) {
    for (std::size_t row = 0; row < rows; ++row) {
      if (now.mission[row] < 0 || now.hovers[row] != 0) continue;
      if (now.timestep[row] == 1) rules[row] = std::make_unique<agents::LookLevel>(context);
      const agents::RcView view = ViewOf(now.controller.data() + row * rfnn::kRcStates);
      const float* ranges = now.ranges.data() + row * 3;
      const robot::MotionCommand command =
          rules[row]->Choose({.view = view, .ranges = {ranges[0], ranges[1], ranges[2]}}).command;
      const agents::RcAction action = agents::ActionOf(command);
      std::copy(action.begin(), action.end(),
                commands.begin() + static_cast<std::ptrdiff_t>(row * kCommandValues));
    }
    fleet.Move(commands);
    fleet.Detect(executions);
  }
  flown.wall_s = Seconds(begin);
  flown.cpu_s = CpuSeconds() - cpu_s;
  return flown;
}

void Bench(const std::string& sweep, std::int64_t missions, int threads,
           const std::vector<std::size_t>& all_rows) {
  sweep::SweepPlan plan = sweep::LoadSweep(sweep);
  sweep::Stage& stage = plan.stages.front();
  stage.arms.resize(1);
  stage.arms.front().config.mission.strategy = "look-level";
  plan.stages.resize(1);
  const Inputs inputs(plan);
  const Config closed = stage.arms.front().config;
  Config outside = closed;
  outside.mission.strategy = agents::kOutsideStrategy;
  const world::Scene& scene = inputs.SceneOf(closed);
  const auto tell = [&](const std::string& what, const Flown& flown, const Flown& loop) {
    const double decisions = 2.0 * static_cast<double>(flown.timesteps);
    fmt::print(
        "{:<14} {:>2} threads  {:>8.0f} decisions/s ({:.0f}/CPU s)  {:>8.0f} simulated s/s ({:.0f}/CPU s)  "
        "of the closed "
        "loop: {:.3f} by the clock, {:.3f} by CPU time\n",
        what, threads, decisions / flown.wall_s, decisions / flown.cpu_s, flown.simulated_s / flown.wall_s,
        flown.simulated_s / flown.cpu_s, loop.wall_s / flown.wall_s, loop.cpu_s / flown.cpu_s);
    std::fflush(stdout);
  };
  const auto keep_best = [](Flown& best, const Flown& flown) {
    const double cpu_s = std::min(best.cpu_s, flown.cpu_s), wall_s = std::min(best.wall_s, flown.wall_s);
    best = flown;
    best.cpu_s = cpu_s, best.wall_s = wall_s;
  };
  for (const std::size_t rows : all_rows) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    Flown best_closed{.wall_s = kInfinite, .cpu_s = kInfinite}, best_stepped = best_closed;
    const int turns = rows < kManyRows ? 3 : 1;
    for (int turn = 0; turn < turns; ++turn) {
      keep_best(best_closed, ClosedLoop(scene, closed, missions, threads));
      keep_best(best_stepped, Stepped(scene, outside, missions, threads, rows));
    }
    tell("closed loop", best_closed, best_closed);
    tell(fmt::format("{} rows", rows), best_stepped, best_closed);
  }
}

}  // namespace
}  // namespace ed3r::schedule

int main(int argc, char** argv) {
  if (argc < 5) {
    fmt::print(stderr, "fleet_bench SWEEP MISSIONS THREADS ROWS...\n");
    return 2;
  }
  std::vector<std::size_t> rows;
  for (int i = 4; i < argc; ++i) rows.push_back(static_cast<std::size_t>(std::atoll(argv[i])));
  ed3r::schedule::Bench(argv[1], std::atoll(argv[2]), std::atoi(argv[3]), rows);
  return 0;
}
