// Decisions that a program outside the engine takes (engine/mission/mission_stepper.h): nobody may ask here.
#pragma once

#include "engine/agents/context.h"
#include "engine/agents/execution_policy.h"
#include "engine/agents/motion_policy.h"
#include "engine/core/check.h"

namespace ed3r::agents {

class OutsideMotion : public MotionPolicy {
 public:
  explicit OutsideMotion(const AgentContext& /*context*/) {}
  MotionChoice Choose(const MotionQuestion& /*question*/) override {
    throw InternalError("the motion of this strategy is decided outside");
  }
};

class OutsideExecution : public ExecutionPolicy {
 public:
  explicit OutsideExecution(const AgentContext& /*context*/) {}
  ExecutionDecision Choose(const ExecutionQuestion& /*question*/) override {
    throw InternalError("the execution of this strategy is decided outside");
  }
};

}  // namespace ed3r::agents
