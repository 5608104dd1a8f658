// The robot agent: decision-making stage 2, where and how detection is executed in timestep k.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "engine/agents/context.h"
#include "engine/agents/execution_policy.h"
#include "engine/agents/views.h"
#include "engine/core/phase.h"

namespace ed3r::agents {

class RobotAgent {
 public:
  explicit RobotAgent(const AgentContext& context) : policy_(context.strategy.execution.make(context)) {}

  // epsilon: the one in force at the RC in this timestep.
  ExecutionDecision ChooseExecution(const RobotView& view, double epsilon, std::uint32_t timestep) {
    const InPhase deciding(Phase::kDecision);
    return policy_->Choose({view, epsilon, timestep});
  }

  // Predicted rewards of offload, Full and Quantized; NaN without a network. For `ed3r explain`.
  std::array<double, 3> PredictAll(const RobotView& view) { return policy_->PredictAll(view); }

 private:
  const std::unique_ptr<ExecutionPolicy> policy_;
};

}  // namespace ed3r::agents
