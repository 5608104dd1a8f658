// The words of the agents' decisions. Their numbers are stored: append, never renumber.
#pragma once

#include <cstdint>

#include "engine/config/field.h"

namespace ed3r {

// Where and how detection is executed (o_k, l_k). The robot's three actions (R17).
enum class Execution : std::int64_t { kOffload = 0, kFull = 1, kQuantized = 2 };
template <>
struct EnumNames<Execution> {
  static constexpr EnumName<Execution> kNames[] = {
      {Execution::kOffload, "offload"}, {Execution::kFull, "full"}, {Execution::kQuantized, "quantized"}};
};

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
template <>
struct EnumNames<MotionRule> {
  static constexpr EnumName<MotionRule> kNames[] = {{MotionRule::kRandom, "random"},
                                                    {MotionRule::kGreedy, "greedy"},
                                                    {MotionRule::kHover, "hover"},
                                                    {MotionRule::kRegionPromising, "region-promising"},
                                                    {MotionRule::kRegionUnexplored, "region-unexplored"},
                                                    {MotionRule::kRegionNearest, "region-nearest"},
                                                    {MotionRule::kOutside, "outside"},
                                                    {MotionRule::kRule, "rule"},
                                                    {MotionRule::kCommanded, "commanded"}};
};

// The Algorithm's branch at this timestep.
enum class ConfidenceBand : std::int64_t {
  kNone = 0,
  kReliable = 1,
  kIntermediate = 2,
  kPersisting = 3,
  kLow = 4
};

}  // namespace ed3r
