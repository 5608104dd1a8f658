// Weights that an ONNX model keeps beside its file ("external data", mine.onnx.data).
#pragma once

#include <string>

namespace ed3r::perception {

// The model with such weights in their places; models without any come back as they are. `path` is the model's, and the
// weights' files must lie in its folder or below it; `name` begins messages. Throws UserError: a file that is missing, lies
// elsewhere or is too short, or more than kMaxModelBytes in all.
std::string WithWeightsInside(std::string bytes, const std::string& path, const std::string& name);

}  // namespace ed3r::perception
