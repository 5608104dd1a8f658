// The words of the agents' decisions. Their numbers are stored: append, never renumber.
#pragma once

#include <cstdint>

#include "engine/config/field.h"

namespace ed3r::agents {

// Where and how detection is executed (o_k, l_k). The robot's three actions (R17).
enum class Execution : std::int64_t { kOffload = 0, kFull = 1, kQuantized = 2 };

}  // namespace ed3r::agents

namespace ed3r {

template <>
struct EnumNames<agents::Execution> {
  static constexpr EnumName<agents::Execution> kNames[] = {{agents::Execution::kOffload, "offload"},
                                                           {agents::Execution::kFull, "full"},
                                                           {agents::Execution::kQuantized, "quantized"}};
};

}  // namespace ed3r

namespace ed3r::agents {

// Which rule produced the motion command.
enum class MotionRule : std::int64_t {
  kRandom = 0,
  kGreedy = 1,
  kHover = 2,
  kRegionPromising = 3,
  kRegionUnexplored = 4,
  kRegionNearest = 5,
  kOutside = 6,    // by a program that steps the mission
  kRule = 7,       // by a strategy's rule
  kCommanded = 8,  // by a network that gives the command itself
};

}  // namespace ed3r::agents

namespace ed3r {

template <>
struct EnumNames<agents::MotionRule> {
  static constexpr EnumName<agents::MotionRule> kNames[] = {
      {agents::MotionRule::kRandom, "random"},
      {agents::MotionRule::kGreedy, "greedy"},
      {agents::MotionRule::kHover, "hover"},
      {agents::MotionRule::kRegionPromising, "region-promising"},
      {agents::MotionRule::kRegionUnexplored, "region-unexplored"},
      {agents::MotionRule::kRegionNearest, "region-nearest"},
      {agents::MotionRule::kOutside, "outside"},
      {agents::MotionRule::kRule, "rule"},
      {agents::MotionRule::kCommanded, "commanded"}};
};

}  // namespace ed3r

namespace ed3r::agents {

// The Algorithm's branch at this timestep.
enum class ConfidenceBand : std::int64_t {
  kNone = 0,
  kReliable = 1,
  kIntermediate = 2,
  kPersisting = 3,
  kLow = 4
};

}  // namespace ed3r::agents
