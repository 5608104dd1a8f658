#include "engine/agents/robot_agent.h"

#include <algorithm>
#include <array>

#include "engine/agents/features.h"
#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r {
namespace {

constexpr std::array kExecutions = {Execution::kOffload, Execution::kFull, Execution::kQuantized};

Execution DrawAllowed(AllowedExecutions allowed, RandomExecution random, Stream& stream) {
  if (random == RandomExecution::kCoin && allowed.offload && allowed.Count() > 1) {
    if (stream.Uniform() < 0.5) return Execution::kOffload;
    allowed.offload = false;
  }
  std::uint32_t index = stream.Below(static_cast<std::uint32_t>(allowed.Count()));
  for (const Execution execution : kExecutions) {
    if (allowed.Allows(execution) && index-- == 0) return execution;
  }
  throw InternalError("a strategy allows no execution");
}

}  // namespace

RobotAgent::RobotAgent(const AgentContext& context) : context_(context) {
  ED3R_CHECK(context.strategy.execution != ExecutionPolicy::kNetwork ||
                 context.strategy.allowed.Count() == 1 || context.networks.robot != nullptr,
             "the strategy asks the robot's network, and there is none");
}

ExecutionDecision RobotAgent::ChooseExecution(const RobotView& view, double epsilon, std::uint32_t timestep) {
  const AllowedExecutions& allowed = context_.strategy.allowed;
  Stream stream(context_.seed, context_.scenario, Purpose::kExecution, timestep);
  if (context_.strategy.execution == ExecutionPolicy::kRules)
    return DecideByRules(context_.config.rbs, view, stream);
  const RandomExecution random = context_.config.agents.random_execution;
  if (allowed.Count() == 1) return {.execution = DrawAllowed(allowed, random, stream)};
  const bool explores =
      context_.strategy.execution == ExecutionPolicy::kRandom ||
      Stream(context_.seed, context_.scenario, Purpose::kRobotExploration, timestep).Uniform() < epsilon;
  if (explores) return {.execution = DrawAllowed(allowed, random, stream), .random = true};

  const std::array<double, 3> rewards = PredictAll(view);
  ExecutionDecision decision;
  decision.predicted_reward = -std::numeric_limits<double>::infinity();
  for (const Execution execution : kExecutions) {
    const double reward = rewards[static_cast<std::size_t>(execution)];
    if (!allowed.Allows(execution) || reward <= decision.predicted_reward) continue;
    decision.execution = execution;
    decision.predicted_reward = reward;
  }
  return decision;
}

std::array<double, 3> RobotAgent::PredictAll(const RobotView& view) {
  std::array<double, 3> rewards;
  rewards.fill(std::numeric_limits<double>::quiet_NaN());
  if (context_.networks.robot == nullptr) return rewards;
  std::array<float, 3 * std::tuple_size_v<RobotAction>> rows{};
  for (const Execution execution : kExecutions) {
    const RobotAction action = ActionOf(execution);
    std::copy(action.begin(), action.end(),
              rows.begin() + static_cast<std::ptrdiff_t>(execution) * action.size());
  }
  context_.networks.robot->Best(StateOf(view), rows, rewards, workspace_);
  return rewards;
}

ExecutionDecision DecideByRules(const RbsConfig& rbs, const RobotView& view, Stream& stream) {
  const double where_draw = stream.Uniform();
  const double model_draw = stream.Uniform();
  const double transmission_margin = view.rate_ratio - rbs.transmission_threshold;
  const double processing_margin = view.cpu_ratio - rbs.processing_threshold;
  const bool both = transmission_margin > 0.0 && processing_margin > 0.0;
  const bool none = transmission_margin <= 0.0 && processing_margin <= 0.0;
  ExecutionDecision decision;
  bool offload = transmission_margin > 0.0;
  if (both) {
    offload = where_draw < 0.5;
    decision.random = true;
  } else if (none) {
    offload = transmission_margin > processing_margin;  // the ratio nearest its threshold
  }
  if (offload) {
    decision.execution = Execution::kOffload;
    return decision;
  }
  switch (rbs.model) {
    case RbsModel::kCoin:
      decision.execution = model_draw < 0.5 ? Execution::kFull : Execution::kQuantized;
      decision.random = true;
      break;
    case RbsModel::kFull:
      decision.execution = Execution::kFull;
      break;
    case RbsModel::kQuantized:
      decision.execution = Execution::kQuantized;
      break;
  }
  return decision;
}

}  // namespace ed3r
