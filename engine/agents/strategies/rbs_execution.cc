#include "engine/agents/strategies/rbs_execution.h"

namespace ed3r::agents {

ExecutionDecision DecideByRules(const RbsConfig& rbs, const RobotView& view, Stream& stream) {
  const double where_draw = stream.Uniform();
  const double model_draw = stream.Uniform();
  const double transmission_margin = view.rate_ratio - rbs.transmission_threshold;
  const double processing_margin = view.cpu_ratio - rbs.processing_threshold;
  const bool both = transmission_margin > 0.0 && processing_margin > 0.0;
  const bool none = transmission_margin <= 0.0 && processing_margin <= 0.0;
  ExecutionDecision decision{.by = DecidedBy::kRules};
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

}  // namespace ed3r::agents
