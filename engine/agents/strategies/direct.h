// Decisions that a network of the user's own gives itself (rfnn/direct_network.h): no candidates, no exploration, no memory.
// What it gives is cut to the ranges and to what the strategy allows, as decisions from outside are.
#pragma once

#include <array>
#include <limits>

#include "engine/agents/context.h"
#include "engine/agents/execution_policy.h"
#include "engine/agents/features.h"
#include "engine/agents/motion_policy.h"
#include "engine/core/check.h"

namespace ed3r::agents {

class DirectMotion : public MotionPolicy {
 public:
  // InternalError without a direct network of the RC.
  explicit DirectMotion(const AgentContext& context) : context_(context) {
    ED3R_CHECK(context.networks.direct_rc != nullptr, "the strategy asks a direct network of the RC");
  }

  MotionChoice Choose(const MotionQuestion& question) override {
    std::array<double, std::tuple_size_v<RcAction>> values{};
    context_.networks.direct_rc->Decide(StateOf(question.view), values, workspace_);
    const robot::MotionCommand given{
        .displacement_m = {values[rfnn::kRcMoveX - rfnn::kRcStates], values[rfnn::kRcMoveY - rfnn::kRcStates],
                           values[rfnn::kRcMoveZ - rfnn::kRcStates]},
        .turn_rad = values[rfnn::kRcTurn - rfnn::kRcStates],
        .tilt_rad = values[rfnn::kRcTiltCommand - rfnn::kRcStates]};
    return {.command = Clamped(given, question.ranges, context_.config.agents, question.view.pose.tilt_rad),
            .rule = MotionRule::kCommanded,
            .epsilon = 0.0};
  }

 private:
  const AgentContext context_;
  rfnn::Model::Workspace workspace_;
};

class DirectExecution : public ExecutionPolicy {
 public:
  // InternalError without a direct network of the robot.
  explicit DirectExecution(const AgentContext& context) : context_(context) {
    ED3R_CHECK(context.networks.direct_robot != nullptr, "the strategy asks a direct network of the robot");
  }

  // Of those that are allowed the one with the largest value, the first among equals.
  ExecutionDecision Choose(const ExecutionQuestion& question) override {
    std::array<double, kExecutions.size()> liked{};
    context_.networks.direct_robot->Decide(StateOf(question.view), liked, workspace_);
    ExecutionDecision decision{.by = DecidedBy::kDirect};
    double best = -std::numeric_limits<double>::infinity();
    for (const Execution execution : kExecutions) {
      const double value = liked[static_cast<std::size_t>(execution)];
      if (!context_.strategy.execution.allowed.Allows(execution) || value <= best) continue;
      decision.execution = execution;
      best = value;
    }
    return decision;
  }

 private:
  const AgentContext context_;
  rfnn::Model::Workspace workspace_;
};

}  // namespace ed3r::agents
