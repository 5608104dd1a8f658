// The remote controller: decision-making stage 1, the motion command of timestep k.
//
// The Algorithm (early_completion.h) speaks first: it may complete the mission or let the robot hover. Else the command
// is the strategy's (motion_policy.h), or one from outside.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "engine/agents/context.h"
#include "engine/agents/early_completion.h"
#include "engine/agents/motion_policy.h"
#include "engine/agents/views.h"

namespace ed3r::agents {

struct MotionDecision {
  bool complete = false;  // the mission ends here; no command
  robot::MotionCommand command;
  MotionRule rule = MotionRule::kRandom;
  ConfidenceBand band = ConfidenceBand::kNone;
  double epsilon = 1.0;
  double predicted_reward =
      std::numeric_limits<double>::quiet_NaN();  // of the command; NaN without a network
};

class RemoteController {
 public:
  explicit RemoteController(const AgentContext& context);

  // To be called once per timestep, k = 1, 2, ... `trace`, where given, receives the candidates of a greedy decision.
  MotionDecision ChooseMotion(const RcView& view, std::uint32_t timestep, CandidateTrace* trace = nullptr);

  // The same in two halves for a command that comes from outside. Observe, once per timestep, says what the Algorithm
  // orders; Take makes the decision, unless the mission is complete. Where the Algorithm hovers, the command is not
  // asked for; elsewhere it is cut to the ranges of the order.
  const CompletionOrder& Observe(const RcView& view, std::uint32_t timestep);
  MotionDecision Take(const RcView& view, const robot::MotionCommand& command);

 private:
  MotionDecision Ordered() const;
  MotionDecision Hover(const RcView& view);

  const AgentContext context_;
  EarlyCompletion completion_;
  CompletionOrder order_;  // of the timestep that was observed last
  const std::unique_ptr<MotionPolicy> policy_;
};

}  // namespace ed3r::agents
