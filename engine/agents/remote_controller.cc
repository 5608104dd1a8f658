#include "engine/agents/remote_controller.h"

namespace ed3r {

RemoteController::RemoteController(const Config& config, const Strategy& strategy, std::uint64_t seed,
                                   std::uint32_t scenario)
    : config_(config), strategy_(strategy), seed_(seed), scenario_(scenario), completion_(config.agents) {}

MotionDecision RemoteController::ChooseMotion(const RcView& view, std::uint32_t timestep) {
  MotionDecision decision;
  ActionRanges ranges = ActionRanges::Full(config_.agents);
  if (strategy_.early_completion && config_.agents.early_completion) {
    const CompletionOrder order = completion_.Next(view.previous_scs);
    decision.band = order.band;
    ranges = order.ranges;
    decision.complete = order.complete;
    if (order.hover) {
      decision.rule = MotionRule::kHover;
      decision.epsilon = 0.0;
      decision.command = {.tilt_rad = view.pose.tilt_rad, .hover = true};
      return decision;
    }
  }
  Stream stream(seed_, scenario_, Purpose::kMotion, timestep);
  decision.command = DrawCommand(ranges, config_.agents, view.pose.tilt_rad, stream);
  return decision;
}

}  // namespace ed3r
