#include "engine/agents/robot_agent.h"

#include <array>

#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r {
namespace {

constexpr std::array kExecutions = {Execution::kOffload, Execution::kFull, Execution::kQuantized};

Execution DrawAllowed(const AllowedExecutions& allowed, Stream& stream) {
  std::uint32_t index = stream.Below(static_cast<std::uint32_t>(allowed.Count()));
  for (const Execution execution : kExecutions) {
    if (allowed.Allows(execution) && index-- == 0) return execution;
  }
  throw InternalError("a strategy allows no execution");
}

}  // namespace

RobotAgent::RobotAgent(const Config& config, const Strategy& strategy, std::uint64_t seed,
                       std::uint32_t scenario)
    : config_(config), strategy_(strategy), seed_(seed), scenario_(scenario) {}

ExecutionDecision RobotAgent::ChooseExecution(const RobotView& view, std::uint32_t timestep) const {
  Stream stream(seed_, scenario_, Purpose::kExecution, timestep);
  if (strategy_.execution == ExecutionPolicy::kRules) return DecideByRules(config_.rbs, view, stream);
  return {.execution = DrawAllowed(strategy_.allowed, stream), .random = strategy_.allowed.Count() > 1};
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
