// ED3R's robot: among the executions that its strategy allows, the one with the largest reward that its network predicts,
// exploring with the RC's epsilon (R17, R20).
#pragma once

#include <array>

#include "engine/agents/context.h"
#include "engine/agents/execution_policy.h"

namespace ed3r::agents {

class GreedyExecution : public ExecutionPolicy {
 public:
  // InternalError without a network of the robot.
  explicit GreedyExecution(const AgentContext& context);

  ExecutionDecision Choose(const ExecutionQuestion& question) override;
  std::array<double, 3> PredictAll(const RobotView& view) override;

 private:
  const AgentContext context_;
  rfnn::Model::Workspace workspace_;
};

}  // namespace ed3r::agents
