#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "engine/app/commands.h"
#include "engine/app/decision_text.h"
#include "engine/app/execution_reason.h"
#include "engine/app/stored_run.h"
#include "engine/app/words.h"
#include "engine/core/check.h"

namespace ed3r::app {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kShownCandidates = 5;

struct Options {
  std::string dir, mission;
  int step = 1;
  std::string cache = "results/cache";
  bool json = false;
};

// Indices into the admitted candidates, best first.
std::vector<std::size_t> Ranking(const agents::CandidateTrace& trace) {
  std::vector<std::size_t> order(trace.rewards.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trace.rewards[a] > trace.rewards[b]; });
  return order;
}

const robot::MotionCommand& CommandAt(const agents::CandidateTrace& trace, std::size_t admitted) {
  const std::size_t index =
      trace.admitted.empty() ? admitted : static_cast<std::size_t>(trace.admitted[admitted]);
  return trace.commands[index];
}

std::string CommandText(const robot::MotionCommand& c) {
  return fmt::format("move ({:+6.2f}, {:+6.2f}, {:+6.2f}) m, turn {:+6.1f} deg, tilt {:4.1f} deg",
                     c.displacement_m.x(), c.displacement_m.y(), c.displacement_m.z(), c.turn_rad / kDegree,
                     c.tilt_rad / kDegree);
}

void PrintCandidates(const agents::CandidateTrace& trace) {
  if (trace.rewards.empty()) return;
  const std::vector<std::size_t> order = Ranking(trace);
  fmt::print("  {} candidates, {} admitted; predicted reward {:.4f} .. {:.4f}, median {:.4f}; the best:\n",
             trace.commands.size(), trace.rewards.size(), trace.rewards[order.back()],
             trace.rewards[order.front()], trace.rewards[order[order.size() / 2]]);
  for (std::size_t i = 0; i < std::min(kShownCandidates, order.size()); ++i)
    fmt::print("    {:8.4f}  {}\n", trace.rewards[order[i]], CommandText(CommandAt(trace, order[i])));
}

// ", the RC expected 0.1234"; nothing where no network was asked.
std::string Expected(const char* who, double reward) {
  return std::isnan(reward) ? "" : fmt::format(", {} expected {:.4f}", who, reward);
}

void PrintText(const mission::MissionTask& task, const mission::DecisionProbe& probe,
               const mission::TimestepRecord& step) {
  const agents::RcView& rc = probe.rc_view;
  fmt::print(
      "stage 1, RC: at ({:.1f}, {:.1f}, {:.1f}) m, {:.1f} m from the RC, previous SCS {:.3f}, energy {:.0f} "
      "J\n",
      rc.pose.position_m.x(), rc.pose.position_m.y(), rc.pose.position_m.z(), rc.rc_distance_m,
      rc.previous_scs, rc.previous_energy_j);
  fmt::print("  {}; epsilon {:.3f}\n", BandText(step.band), step.epsilon);
  fmt::print("  chosen ({}): {}\n", NameOf(static_cast<agents::MotionRule>(step.motion_rule)),
             CommandText(probe.motion.command));
  PrintCandidates(probe.candidates);
  fmt::print("  arrived at ({:.1f}, {:.1f}, {:.1f}) m{}\n", step.x_m, step.y_m, step.z_m,
             step.halted != 0 ? "; halted by an obstacle" : "");
  fmt::print("stage 2, robot: battery {:.1f} %, CPU {:.2f} GHz, {:.1f} m from the RC, {:.1f} Mbit/s\n",
             100.0 * probe.robot_view.battery_ratio, step.cpu_hz / 1e9, step.rc_distance_m,
             step.rate_bps / 1e6);
  fmt::print("{}", ExecutionText(task, probe));
  fmt::print("detection: mean {:.3f}, sd {:.3f}, SCS {:.3f}; fire {}in view\n", step.confidence_mean,
             step.confidence_sd, step.scs, step.fire_in_view != 0 ? "" : "not ");
  fmt::print("energy {:.0f} J; reward {:.4f}{}{}\n", step.total_j, step.reward,
             Expected("the RC", step.rc_predicted_reward),
             Expected("the robot", step.robot_predicted_reward));
}

void PrintJson(const mission::MissionTask& task, const mission::DecisionProbe& probe,
               const mission::TimestepRecord& step) {
  nlohmann::ordered_json object;
  mission::TimestepRecord::Describe(step, [&](std::string_view name, const auto& value) {
    object["timestep"][std::string(name)] = value;  // NaN becomes null
  });
  object["motion_rule"] = NameOf(static_cast<agents::MotionRule>(step.motion_rule));
  object["band"] = BandText(step.band);
  object["candidates"] = {{"drawn", probe.candidates.commands.size()},
                          {"admitted", probe.candidates.rewards.size()}};
  const std::vector<std::size_t> order = Ranking(probe.candidates);
  for (std::size_t i = 0; i < std::min(kShownCandidates, order.size()); ++i) {
    const robot::MotionCommand& c = CommandAt(probe.candidates, order[i]);
    object["candidates"]["best"].push_back({{"predicted_reward", probe.candidates.rewards[order[i]]},
                                            {"dx_m", c.displacement_m.x()},
                                            {"dy_m", c.displacement_m.y()},
                                            {"dz_m", c.displacement_m.z()},
                                            {"turn_rad", c.turn_rad},
                                            {"tilt_rad", c.tilt_rad}});
  }
  AddExecution(task, probe, object);
  fmt::print("{}\n", object.dump(2));
}

int Explain(const Options& options) {
  StoredRun run(options.dir, options.cache);
  const sweep::RunId id = run.Find(options.mission);
  const store::StoredMission stored = run.Reader().LoadMission(id);
  if (options.step < 1 || options.step > stored.record.timesteps)
    throw UserError(
        fmt::format("--step: '{}' is not allowed; allowed: 1 .. {}", options.step, stored.record.timesteps));
  mission::DecisionProbe probe;
  probe.timestep = static_cast<std::uint32_t>(options.step);
  mission::MissionTask task = run.Task(id);
  task.probe = &probe;
  const mission::MissionRecord flown = mission::FlyMission(task);
  // Candidates are of this flight: beside numbers of another one they would explain nothing.
  if (!run.Reader().IsStored(flown, stored))
    throw UserError(fmt::format(
        "{0}: flown again it is not the stored mission, which other code or another C library flew: "
        "there is nothing to explain; 'ed3r replay {1} {0}' tells more",
        options.mission, options.dir));
  ED3R_CHECK(probe.reached, "the mission ended before the stored one");
  const mission::TimestepRecord& step = flown.steps[static_cast<std::size_t>(options.step - 1)];
  options.json ? PrintJson(task, probe, step) : PrintText(task, probe, step);
  FlushOutput();
  TellNotes(run.Notes());
  return kDone;
}

}  // namespace

Command AddExplain(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "explain",
      "Why a timestep went as it did: candidates, predicted rewards, mechanism, chosen action, reward");
  parser.Option("DIR", options->dir, "Run directory").Required();
  parser.Option("MISSION", options->mission, "ARM/NUMBER, e.g. ed3r-75/12; missions count from 0").Required();
  parser.Option("--step", options->step, "Timestep; timesteps count from 1").Required();
  parser.Option("--cache", options->cache, "Where trained networks are kept; default results/cache");
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] { return Explain(*options); }};
}

}  // namespace ed3r::app
