// Motion drawn uniformly from the ranges: the warm-up and RBS (R25).
#pragma once

#include "engine/agents/context.h"
#include "engine/agents/motion_policy.h"
#include "engine/core/random.h"

namespace ed3r::agents {

class RandomWalk : public MotionPolicy {
 public:
  explicit RandomWalk(const AgentContext& context) : context_(context) {}

  MotionChoice Choose(const MotionQuestion& question) override {
    Stream stream(context_.seed, context_.scenario, Purpose::kMotion, question.timestep);
    return {.command =
                DrawCommand(question.ranges, context_.config.agents, question.view.pose.tilt_rad, stream)};
  }

 private:
  const AgentContext context_;
};

}  // namespace ed3r::agents
