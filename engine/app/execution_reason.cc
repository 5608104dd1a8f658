#include "engine/app/execution_reason.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

#include "engine/agents/strategies/rbs_execution.h"
#include "engine/agents/strategy.h"
#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r::app {
namespace {

// A step through the rules of RBS (R25), as DecideByRules takes it.
struct RulePath {
  double rate_margin, cpu_margin;    // ratios minus their thresholds
  std::optional<double> where_draw;  // of the coins that were asked
  std::optional<double> model_draw;
  agents::Execution execution;

  bool RateExceeds() const { return rate_margin > 0.0; }
  bool CpuExceeds() const { return cpu_margin > 0.0; }
};

RulePath FollowRules(const mission::MissionTask& task, const mission::DecisionProbe& probe) {
  const RbsConfig& rbs = task.config.rbs;
  const agents::RobotView& view = probe.robot_view;
  Stream stream(task.seed, task.scenario, Purpose::kExecution, probe.timestep);
  const double where_draw = stream.Uniform(), model_draw = stream.Uniform();
  RulePath path{.rate_margin = view.rate_ratio - rbs.transmission_threshold,
                .cpu_margin = view.cpu_ratio - rbs.processing_threshold,
                .where_draw = {},
                .model_draw = {},
                .execution = probe.execution.execution};
  if (path.RateExceeds() && path.CpuExceeds()) path.where_draw = where_draw;
  if (path.execution != agents::Execution::kOffload && rbs.model == RbsModel::kCoin)
    path.model_draw = model_draw;
  // What is told must be what was done.
  Stream again(task.seed, task.scenario, Purpose::kExecution, probe.timestep);
  ED3R_CHECK(agents::DecideByRules(rbs, view, again).execution == path.execution,
             "the rules decide otherwise");
  return path;
}

const char* Above(bool exceeds) { return exceeds ? "above" : "not above"; }

std::string WhereText(const RulePath& path) {
  const char* where = path.execution == agents::Execution::kOffload ? "offload" : "local";
  if (path.where_draw)
    return fmt::format("{} by a coin, as both are above (draw {:.3f}; offload below 0.5)", where,
                       *path.where_draw);
  if (path.RateExceeds() || path.CpuExceeds())
    return fmt::format("{}, as the {} alone is above its threshold", where,
                       path.RateExceeds() ? "rate" : "CPU");
  return fmt::format("{}, as neither is above and the {} is nearer its threshold", where,
                     path.rate_margin > path.cpu_margin ? "rate" : "CPU");
}

std::string RulesText(const mission::MissionTask& task, const mission::DecisionProbe& probe) {
  const RbsConfig& rbs = task.config.rbs;
  const RulePath path = FollowRules(task, probe);
  std::string text =
      fmt::format("  rate / (b_max se_max) {:.3f}: {} rbs.transmission_threshold {}\n",
                  probe.robot_view.rate_ratio, Above(path.RateExceeds()), rbs.transmission_threshold) +
      fmt::format("  f / f_max             {:.3f}: {} rbs.processing_threshold {}\n",
                  probe.robot_view.cpu_ratio, Above(path.CpuExceeds()), rbs.processing_threshold) +
      fmt::format("  where (R25): {}\n", WhereText(path));
  if (path.execution == agents::Execution::kOffload) return text + "  > offload\n";
  const std::string model = path.model_draw
                                ? fmt::format("by a coin (draw {:.3f}; full below 0.5)", *path.model_draw)
                                : "as rbs.model says";
  return text + fmt::format("  model: {}\n  > {}\n", model, NameOf(path.execution));
}

nlohmann::ordered_json RulesJson(const mission::MissionTask& task, const mission::DecisionProbe& probe) {
  const RulePath path = FollowRules(task, probe);
  nlohmann::ordered_json json = {{"rate_ratio", probe.robot_view.rate_ratio},
                                 {"transmission_threshold", task.config.rbs.transmission_threshold},
                                 {"rate_exceeds", path.RateExceeds()},
                                 {"cpu_ratio", probe.robot_view.cpu_ratio},
                                 {"processing_threshold", task.config.rbs.processing_threshold},
                                 {"cpu_exceeds", path.CpuExceeds()}};
  if (path.where_draw) json["where_draw"] = *path.where_draw;
  if (path.model_draw) json["model_draw"] = *path.model_draw;
  return json;
}

const char* WhoDecided(agents::DecidedBy by) {
  constexpr const char* kNames[] = {"rules", "network", "draw", "strategy", "direct"};
  return kNames[static_cast<std::size_t>(by)];
}

std::string AllowedNames(const agents::Strategy& strategy) {
  std::vector<std::string_view> names;
  for (const auto& [value, name] : EnumNames<agents::Execution>::kNames)
    if (strategy.execution.allowed.Allows(value)) names.push_back(name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string ChoiceText(agents::DecidedBy by, const agents::Strategy& strategy) {
  switch (by) {
    case agents::DecidedBy::kDraw:
      return "drawn at random from " + AllowedNames(strategy);
    case agents::DecidedBy::kStrategy:
      return "the only execution of this strategy";
    case agents::DecidedBy::kDirect:
      return "what the network likes best of " + AllowedNames(strategy);
    default:
      return fmt::format("the best prediction among {}", AllowedNames(strategy));
  }
}

}  // namespace

std::string ExecutionText(const mission::MissionTask& task, const mission::DecisionProbe& probe) {
  const agents::Strategy& strategy = agents::FindStrategy(task.config.mission.strategy);
  const agents::DecidedBy by = probe.execution.by;
  if (by == agents::DecidedBy::kRules) return RulesText(task, probe);
  std::string text;
  for (const auto& [value, name] : EnumNames<agents::Execution>::kNames) {
    const double reward = probe.robot_rewards[static_cast<std::size_t>(value)];
    if (!std::isnan(reward)) text += fmt::format("  {:<10} predicted reward {:.4f}\n", name, reward);
  }
  return text + fmt::format("  > {}: {}\n", NameOf(probe.execution.execution), ChoiceText(by, strategy));
}

void AddExecution(const mission::MissionTask& task, const mission::DecisionProbe& probe,
                  nlohmann::ordered_json& object) {
  const agents::DecidedBy by = probe.execution.by;
  object["execution"] = NameOf(probe.execution.execution);
  object["execution_by"] = WhoDecided(by);
  if (by == agents::DecidedBy::kRules) object["rules"] = RulesJson(task, probe);
  for (const auto& [value, name] : EnumNames<agents::Execution>::kNames) {
    const double reward = probe.robot_rewards[static_cast<std::size_t>(value)];
    if (!std::isnan(reward)) object["robot_predicted_rewards"][std::string(name)] = reward;
  }
}

}  // namespace ed3r::app
