// How a strategy's robot chooses where and how detection is executed (decision-making stage 2).
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "engine/agents/decisions.h"
#include "engine/agents/views.h"

namespace ed3r::agents {

inline constexpr std::array kExecutions = {Execution::kOffload, Execution::kFull, Execution::kQuantized};

// Set of Execution values that a robot may choose from.
struct AllowedExecutions {
  bool offload = true;
  bool full = true;
  bool quantized = true;

  constexpr bool Allows(Execution execution) const {
    return (execution == Execution::kOffload && offload) || (execution == Execution::kFull && full) ||
           (execution == Execution::kQuantized && quantized);
  }
  constexpr int Count() const { return int{offload} + int{full} + int{quantized}; }
};

// What made a choice, for `ed3r explain`; not stored.
enum class DecidedBy { kRules, kNetwork, kDraw, kStrategy, kDirect };

struct ExecutionDecision {
  Execution execution = Execution::kFull;
  bool random = false;                                                 // drawn, not deduced
  double predicted_reward = std::numeric_limits<double>::quiet_NaN();  // NaN where no network was asked
  DecidedBy by = DecidedBy::kStrategy;
};

struct ExecutionQuestion {
  const RobotView& view;
  double epsilon = 1.0;  // the one in force at the RC in this timestep
  std::uint32_t timestep = 1;
};

// One mission, one thread.
class ExecutionPolicy {
 public:
  virtual ~ExecutionPolicy() = default;

  virtual ExecutionDecision Choose(const ExecutionQuestion& question) = 0;

  // Predicted rewards of offload, Full and Quantized; NaN without a network. For `ed3r explain`.
  virtual std::array<double, 3> PredictAll(const RobotView& view) {
    static_cast<void>(view);
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone, kNone};
  }
};

}  // namespace ed3r::agents
