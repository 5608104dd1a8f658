#include "engine/agents/early_completion.h"

namespace ed3r::agents {

EarlyCompletion::EarlyCompletion(const AgentsConfig& agents)
    : agents_(agents), ranges_(ActionRanges::Full(agents)) {}

CompletionOrder EarlyCompletion::Next(double previous_scs) {
  CompletionOrder order;
  if (previous_scs >= agents_.eta_min) {  // line 3
    order.band = ConfidenceBand::kReliable;
    order.hover = true;  // line 4
    ++stop_count_;
    low_count_ = 0;
    order.epsilon = 0.0;
    order.complete = stop_count_ >= agents_.completion_patience;  // line 5
  } else if (previous_scs >= agents_.eta_int) {                   // line 6
    stop_count_ = 0;                                              // line 7
    ++low_count_;
    if (low_count_ < agents_.low_confidence_patience) {  // line 8
      order.band = ConfidenceBand::kIntermediate;
      // The ranges shrink from their full size: a second approach starts like the first (R21).
      ranges_ = ActionRanges::Full(agents_).Decreased(agents_);  // line 9
      order.epsilon = 0.0;
    } else {
      order.band = ConfidenceBand::kPersisting;
      ranges_ = ranges_.Increased(agents_);  // line 11
      order.epsilon = 1.0;
    }
  } else {  // line 14
    order.band = ConfidenceBand::kLow;
    ranges_ = ActionRanges::Full(agents_);
    stop_count_ = 0;
    low_count_ = 0;
    if (agents_.else_branch == ElseBranch::kZero) order.epsilon = 0.0;
  }
  order.ranges = ranges_;
  return order;
}

}  // namespace ed3r::agents
