#include "engine/agents/reward.h"

#include <algorithm>

namespace ed3r::agents {

double Reward(const AgentsConfig& agents, double total_energy_j, double scs, double battery_j) {
  const double constraint_penalty =
      std::max(0.0, agents.eta_min - scs) +
      std::max(0.0, (total_energy_j - battery_j) / agents.energy_scale_j);                          // Eq. 15
  const double detection_penalty = 1.0 - scs;                                                       // Eq. 16
  const double penalty = agents.lambda1 * constraint_penalty + agents.lambda2 * detection_penalty;  // Eq. 17
  return -(agents.mu1 * total_energy_j / agents.energy_scale_j + agents.mu2 * penalty);             // Eq. 21
}

}  // namespace ed3r::agents
