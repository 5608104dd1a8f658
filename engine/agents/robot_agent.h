// The robot agent: decision-making stage 2, where and how detection is executed in timestep k.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "engine/agents/context.h"
#include "engine/agents/views.h"
#include "engine/core/random.h"

namespace ed3r {

struct ExecutionDecision {
  Execution execution = Execution::kFull;
  bool random = false;                                                 // drawn, not deduced
  double predicted_reward = std::numeric_limits<double>::quiet_NaN();  // NaN where no network was asked
};

class RobotAgent {
 public:
  explicit RobotAgent(const AgentContext& context);

  // epsilon: the one in force at the RC in this timestep.
  ExecutionDecision ChooseExecution(const RobotView& view, double epsilon, std::uint32_t timestep);

  // Predicted rewards of offload, Full and Quantized; NaN without a network. For `ed3r explain`.
  std::array<double, 3> PredictAll(const RobotView& view);

 private:
  const AgentContext context_;
  Model::Workspace workspace_;
};

// The distributed rule-based heuristic (Appendix, Baselines; R25). Takes exactly two draws.
ExecutionDecision DecideByRules(const RbsConfig& rbs, const RobotView& view, Stream& stream);

}  // namespace ed3r
