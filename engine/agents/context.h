// What an agent of one mission is made from.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "engine/agents/strategy.h"
#include "engine/config/config.h"
#include "engine/rfnn/direct_network.h"
#include "engine/rfnn/model.h"

namespace ed3r::agents {

// Networks, shared read-only; null where a strategy asks none. A direct one goes before one that scores actions.
struct Networks {
  const rfnn::Model* rc = nullptr;
  const rfnn::Model* robot = nullptr;
  const rfnn::DirectNetwork* direct_rc = nullptr;
  const rfnn::DirectNetwork* direct_robot = nullptr;
};

struct AgentContext {
  const Config& config;
  const Strategy& strategy;
  Networks networks;
  Eigen::Vector3d size_m;  // of the searched area, for the regions
  std::uint64_t seed = 0;
  std::uint32_t scenario = 0;
  double epsilon = 1.0;  // of this mission where the Algorithm forces none (R20)
};

// max(epsilon_min, decay^i) (R20), i the mission's number in an online phase of epsilon_missions: any missions in a row are
// spread over it evenly, and that many in a row are each of it once. Strategies that walk at random do not ask.
double EpsilonOfMission(const AgentsConfig& agents, int mission);

}  // namespace ed3r::agents
