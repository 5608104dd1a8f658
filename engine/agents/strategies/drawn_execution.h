// Execution drawn at random, as in the warm-up (R26, R36), and the strategies' only one.
#pragma once

#include "engine/agents/context.h"
#include "engine/agents/execution_policy.h"
#include "engine/config/agents.h"
#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r::agents {

inline Execution DrawAllowed(AllowedExecutions allowed, RandomExecution random, Stream& stream) {
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

class DrawnExecution : public ExecutionPolicy {
 public:
  explicit DrawnExecution(const AgentContext& context) : context_(context) {}

  ExecutionDecision Choose(const ExecutionQuestion& question) override {
    Stream stream(context_.seed, context_.scenario, Purpose::kExecution, question.timestep);
    return {.execution = DrawAllowed(context_.strategy.execution.allowed,
                                     context_.config.agents.random_execution, stream),
            .random = true,
            .by = DecidedBy::kDraw};
  }

 private:
  const AgentContext context_;
};

template <Execution kExecution>
class OnlyExecution : public ExecutionPolicy {
 public:
  explicit OnlyExecution(const AgentContext& /*context*/) {}

  ExecutionDecision Choose(const ExecutionQuestion& /*question*/) override {
    return {.execution = kExecution, .by = DecidedBy::kStrategy};
  }
};

}  // namespace ed3r::agents
