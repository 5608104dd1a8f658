#include "engine/python/networks.h"

#include <fmt/format.h>

#include "engine/core/check.h"

namespace ed3r {

std::string NetworkBytes(const DenseChain& chain, const std::string& name, const std::string& agent) {
  for (const NetworkDesign* design : {&kRcNetwork, &kRobotNetwork})
    if (agent == design->name) return OnnxBytes(chain, name, *design);
  throw UserError(fmt::format("agent: '{}' is not allowed; allowed: {} | {}", agent, kRcNetwork.name,
                              kRobotNetwork.name));
}

}  // namespace ed3r
