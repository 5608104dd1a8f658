#include "engine/agents/remote_controller.h"

#include "engine/core/check.h"
#include "engine/core/phase.h"

namespace ed3r::agents {

RemoteController::RemoteController(const AgentContext& context)
    : context_(context), completion_(context.config.agents), policy_(context.strategy.motion.make(context)) {}

const CompletionOrder& RemoteController::Observe(const RcView& view, std::uint32_t timestep) {
  const AgentsConfig& agents = context_.config.agents;
  if (timestep > 1) policy_->Observe(view);
  if (context_.strategy.early_completion && agents.early_completion)
    order_ = completion_.Next(view.previous_scs);
  else
    order_.ranges = ActionRanges::Full(agents);
  return order_;
}

MotionDecision RemoteController::ChooseMotion(const RcView& view, std::uint32_t timestep,
                                              CandidateTrace* trace) {
  const InPhase deciding(Phase::kDecision);
  Observe(view, timestep);
  if (order_.hover) return Hover(view);
  MotionDecision decision = Ordered();
  const MotionChoice choice =
      policy_->Choose({view, order_.ranges, order_.epsilon.value_or(context_.epsilon), timestep, trace});
  decision.command = choice.command;
  decision.rule = choice.rule;
  decision.epsilon = choice.epsilon;
  decision.predicted_reward = choice.predicted_reward;
  return decision;
}

MotionDecision RemoteController::Take(const RcView& view, const robot::MotionCommand& command) {
  ED3R_CHECK(!order_.complete, "a command for a mission that is complete");
  if (order_.hover) return Hover(view);
  MotionDecision decision = Ordered();
  decision.command = Clamped(command, order_.ranges, context_.config.agents, view.pose.tilt_rad);
  decision.rule = MotionRule::kOutside;
  decision.epsilon = 0.0;
  return decision;
}

MotionDecision RemoteController::Ordered() const {
  MotionDecision decision;
  decision.complete = order_.complete;
  decision.band = order_.band;
  return decision;
}

MotionDecision RemoteController::Hover(const RcView& view) {
  MotionDecision decision = Ordered();
  decision.rule = MotionRule::kHover;
  decision.epsilon = order_.epsilon.value_or(context_.epsilon);
  decision.command = {.tilt_rad = view.pose.tilt_rad, .hover = true};
  decision.predicted_reward = policy_->Predict(view, decision.command);
  return decision;
}

}  // namespace ed3r::agents
