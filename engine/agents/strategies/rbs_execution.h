// The distributed rule-based heuristic of RBS (Appendix, Baselines; R25).
#pragma once

#include "engine/agents/context.h"
#include "engine/agents/execution_policy.h"
#include "engine/core/random.h"

namespace ed3r::agents {

// Takes exactly two draws.
ExecutionDecision DecideByRules(const RbsConfig& rbs, const RobotView& view, Stream& stream);

class RbsExecution : public ExecutionPolicy {
 public:
  explicit RbsExecution(const AgentContext& context) : context_(context) {}

  ExecutionDecision Choose(const ExecutionQuestion& question) override {
    Stream stream(context_.seed, context_.scenario, Purpose::kExecution, question.timestep);
    return DecideByRules(context_.config.rbs, question.view, stream);
  }

 private:
  const AgentContext context_;
};

}  // namespace ed3r::agents
