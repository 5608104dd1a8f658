// The strategies as data: each is composed of how the RC moves the robot and how the robot detects (paper: Result 2,
// Table of ablations; Appendix, Baselines; R25, R26).
//
// A new strategy is a class in strategies/ and a row of the table in strategy.cc.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/agents/execution_policy.h"
#include "engine/agents/motion_policy.h"

namespace ed3r::agents {

struct AgentContext;

struct MotionPart {
  std::unique_ptr<MotionPolicy> (*make)(const AgentContext& context) = nullptr;
  bool asks_network = false;  // of the RC
  bool operator==(const MotionPart&) const = default;
};

struct ExecutionPart {
  std::unique_ptr<ExecutionPolicy> (*make)(const AgentContext& context) = nullptr;
  AllowedExecutions allowed;  // what it chooses from
  bool asks_network = false;  // of the robot
};

struct Strategy {
  std::string_view name;
  MotionPart motion;
  ExecutionPart execution;
  bool early_completion;      // the RC follows the Algorithm
  std::string_view networks;  // warm-up whose networks it uses: a strategy name, "" for none
  // Its decisions come from outside the engine: a program that steps the missions (engine/mission/mission_stepper.h).
  bool outside = false;
};

inline constexpr std::string_view kOutsideStrategy = "external";

std::span<const Strategy> Strategies();

// "" for a known name, else a clause that lists the names and the nearest one.
std::string CheckStrategyName(std::string_view name);

// Throws UserError with that clause for an unknown name.
const Strategy& FindStrategy(std::string_view name);

}  // namespace ed3r::agents
