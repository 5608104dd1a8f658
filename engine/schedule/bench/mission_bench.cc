// What a mission costs: processor time, calls of operator new, and perception alone.
//   build/bench/engine/schedule/mission_bench SWEEP MISSIONS
// The sweep's first arm gives world, parameters and strategy, one that needs no network. Three lines:
//   flown      simulated seconds a second of processor time, and physics steps
//   re-scored  every timestep seen again from the pose that is in its record, by the sensor that the mission had: the time of flying
//              over that of seeing alone. Stops where a score is not, to the bit, the one in the record.
//   allocated  calls of operator new a timestep: the slope over missions of different length, so that what is made once for a mission
//              (its own line) is apart. Bullet's memory does not come from operator new.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "engine/agents/decisions.h"
#include "engine/core/check.h"
#include "engine/mission/mission.h"
#include "engine/perception/sensor.h"
#include "engine/schedule/inputs.h"
#include "engine/sweep/sweep_file.h"

namespace {

thread_local std::int64_t allocations = 0;

void* Counted(std::size_t bytes, std::size_t alignment) {
  ++allocations;
  const std::size_t whole = (std::max<std::size_t>(bytes, 1) + alignment - 1) / alignment * alignment;
  if (void* memory = std::aligned_alloc(alignment, whole)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t bytes) { return Counted(bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }
void* operator new[](std::size_t bytes) { return Counted(bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return Counted(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return Counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace ed3r::schedule {
namespace {

struct Flown {
  mission::MissionRecord record;
  std::int64_t allocations = 0;
};

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

mission::MissionTask TaskFor(const world::Scene& scene, const Config& config, std::uint64_t seed,
                             int mission) {
  mission::MissionTask task{.scene = scene, .config = config};
  task.seed = seed;
  task.scenario = static_cast<std::uint32_t>(mission);
  task.mission = mission;
  return task;
}

void TellAllocations(const std::vector<Flown>& flown) {
  double mean_steps = 0, mean_calls = 0, squares = 0, products = 0;
  const auto n = static_cast<double>(flown.size());
  for (const Flown& one : flown) {
    mean_steps += static_cast<double>(one.record.timesteps) / n;
    mean_calls += static_cast<double>(one.allocations) / n;
  }
  for (const Flown& one : flown) {
    const double off = static_cast<double>(one.record.timesteps) - mean_steps;
    squares += off * off;
    products += off * (static_cast<double>(one.allocations) - mean_calls);
  }
  const double slope = squares > 0 ? products / squares : 0.0;
  fmt::print(
      "allocated  {:.2f} calls of operator new a timestep, {:.0f} a mission beside them ({:.1f} timesteps)\n",
      slope, mean_calls - slope * mean_steps, mean_steps);
}

// Returns how many timesteps were seen; throws at the first that is not what the record says.
std::int64_t SeeAgain(const world::Scene& scene, const Config& config, std::uint64_t seed,
                      const mission::MissionRecord& record) {
  const auto sensor = perception::MakeProfileSensor(
      scene, config, {static_cast<int>(record.site), seed, static_cast<std::uint32_t>(record.scenario)});
  std::uint32_t view = 1;  // the timestep in which the robot came to where it is
  for (const mission::TimestepRecord& step : record.steps) {
    const auto k = static_cast<std::uint32_t>(step.k);
    if (step.motion_rule != static_cast<std::int64_t>(agents::MotionRule::kHover)) view = k;
    const perception::DetectionModel model =
        step.execution == static_cast<std::int64_t>(agents::Execution::kQuantized)
            ? perception::DetectionModel::kQuantized
            : perception::DetectionModel::kFull;
    const perception::Detection seen =
        sensor->Sense({{step.x_m, step.y_m, step.z_m}, step.yaw_rad, step.tilt_rad}, model, k, view);
    ED3R_CHECK(seen.score.scs == step.scs && seen.fire_only_scs == step.fire_only_scs,
               fmt::format("scenario {}, timestep {}: {} seen again, {} recorded", record.scenario, k,
                           seen.score.scs, step.scs));
  }
  return static_cast<std::int64_t>(record.steps.size());
}

void Bench(const std::string& sweep, int missions) {
  const sweep::SweepPlan plan = sweep::LoadSweep(sweep);
  const Inputs inputs(plan);
  const Config& config = plan.stages.front().arms.front().config;
  const world::Scene& scene = inputs.SceneOf(config);
  mission::FlyMission(TaskFor(scene, config, plan.seed, 0));  // what is made once is not counted
  std::vector<Flown> flown(static_cast<std::size_t>(missions));
  const double begin_s = CpuSeconds();
  double simulated_s = 0, moving_s = 0;
  for (int i = 0; i < missions; ++i) {
    const std::int64_t before = allocations;
    mission::MissionRecord record = mission::FlyMission(TaskFor(scene, config, plan.seed, i));
    flown[static_cast<std::size_t>(i)] = {std::move(record), allocations - before};
  }
  const double flying_s = CpuSeconds() - begin_s;
  for (const Flown& one : flown) {
    simulated_s += one.record.duration_s;
    for (const mission::TimestepRecord& step : one.record.steps)
      moving_s += step.horizontal_s + step.ascent_s + step.descent_s + step.turning_s;
  }
  fmt::print(
      "flown      {} missions, {:.3f} ms each, {:.0f} simulated seconds a processor second, {:.0f} physics "
      "steps a "
      "processor second\n",
      missions, 1e3 * flying_s / missions, simulated_s / flying_s,
      config.mission.physics_hz * moving_s / flying_s);
  const double seeing_s = CpuSeconds();
  std::int64_t seen = 0;
  for (const Flown& one : flown) seen += SeeAgain(scene, config, plan.seed, one.record);
  const double scoring_s = CpuSeconds() - seeing_s;
  fmt::print(
      "re-scored  {} timesteps, all as recorded, {:.1f} us each, {:.1f} times faster than flying them\n",
      seen, 1e6 * scoring_s / static_cast<double>(seen), flying_s / scoring_s);
  TellAllocations(flown);
}

}  // namespace
}  // namespace ed3r::schedule

int main(int argc, char** argv) {
  if (argc != 3 || std::atoi(argv[2]) < 2) {
    fmt::print(stderr, "mission_bench SWEEP MISSIONS\n");
    return 2;
  }
  ed3r::schedule::Bench(argv[1], std::atoi(argv[2]));
  return 0;
}
