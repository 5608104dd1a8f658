#include "engine/agents/context.h"

#include <algorithm>
#include <cmath>

namespace ed3r::agents {

double EpsilonOfMission(const AgentsConfig& agents, int mission) {
  return std::max(agents.epsilon_min, std::pow(agents.epsilon_decay, mission));
}

}  // namespace ed3r::agents
