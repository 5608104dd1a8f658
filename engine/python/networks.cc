#include "engine/python/networks.h"

#include <fmt/format.h>

#include "engine/core/check.h"

namespace ed3r::python {

std::string NetworkBytes(const rfnn::DenseChain& chain, const std::string& name, const std::string& agent) {
  for (const rfnn::NetworkDesign* design : {&rfnn::kRcNetwork, &rfnn::kRobotNetwork})
    if (agent == design->name) return rfnn::OnnxBytes(chain, name, *design);
  throw UserError(fmt::format("agent: '{}' is not allowed; allowed: {} | {}", agent, rfnn::kRcNetwork.name,
                              rfnn::kRobotNetwork.name));
}

}  // namespace ed3r::python
