// The mutual reward of both agents (Eqs. 15-18, 21; R32).
#pragma once

#include "engine/config/agents.h"

namespace ed3r::agents {

// rr_k = -(mu1 E + mu2 (lambda1 P_constr + lambda2 P_det)), each term on its own scale: energies in units of
// agents.energy_scale_j, confidences as they are. The motion range terms of P_constr are zero: commands are
// drawn inside their ranges. battery_j is beta_k, the charge before the timestep.
double Reward(const AgentsConfig& agents, double total_energy_j, double scs, double battery_j);

}  // namespace ed3r::agents
