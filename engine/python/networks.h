// Networks of numbers that Python has, as files for networks.rc and networks.robot.
#pragma once

#include <string>

#include "engine/rfnn/onnx_network.h"

namespace ed3r::python {

// agent: rc | robot. Throws UserError that begins with `name` for what no sweep would take.
std::string NetworkBytes(const rfnn::DenseChain& chain, const std::string& name, const std::string& agent);

}  // namespace ed3r::python
