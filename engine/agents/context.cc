#include "engine/agents/context.h"

#include <algorithm>
#include <cmath>

namespace ed3r {

double EpsilonOfMission(const AgentsConfig& agents, const Strategy& strategy, int mission) {
  if (strategy.motion == MotionPolicy::kRandom) return 1.0;
  return std::max(agents.epsilon_min, std::pow(agents.epsilon_decay, mission));
}

}  // namespace ed3r
