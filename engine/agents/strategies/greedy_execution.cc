#include "engine/agents/strategies/greedy_execution.h"

#include <algorithm>

#include "engine/agents/features.h"
#include "engine/agents/strategies/drawn_execution.h"
#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r::agents {

GreedyExecution::GreedyExecution(const AgentContext& context) : context_(context) {
  ED3R_CHECK(context.networks.robot != nullptr, "the strategy asks the robot's network, and there is none");
}

ExecutionDecision GreedyExecution::Choose(const ExecutionQuestion& question) {
  const double draw =
      Stream(context_.seed, context_.scenario, Purpose::kRobotExploration, question.timestep).Uniform();
  if (draw < question.epsilon) return DrawnExecution(context_).Choose(question);

  const AllowedExecutions& allowed = context_.strategy.execution.allowed;
  const std::array<double, 3> rewards = PredictAll(question.view);
  ExecutionDecision decision{.by = DecidedBy::kNetwork};
  decision.predicted_reward = -std::numeric_limits<double>::infinity();
  for (const Execution execution : kExecutions) {
    const double reward = rewards[static_cast<std::size_t>(execution)];
    if (!allowed.Allows(execution) || reward <= decision.predicted_reward) continue;
    decision.execution = execution;
    decision.predicted_reward = reward;
  }
  return decision;
}

std::array<double, 3> GreedyExecution::PredictAll(const RobotView& view) {
  std::array<double, 3> rewards{};
  std::array<float, 3 * std::tuple_size_v<RobotAction>> rows{};
  for (const Execution execution : kExecutions) {
    const RobotAction action = ActionOf(execution);
    std::copy(action.begin(), action.end(),
              rows.begin() + static_cast<std::ptrdiff_t>(execution) * action.size());
  }
  context_.networks.robot->Best(StateOf(view), rows, rewards, workspace_);
  return rewards;
}

}  // namespace ed3r::agents
