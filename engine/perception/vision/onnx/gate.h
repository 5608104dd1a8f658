// What an ONNX file may hold before OpenCV's reader sees it, which believes every number in it.
#pragma once

#include <string>
#include <string_view>

namespace ed3r::perception {

// Walks the file's protocol-buffer messages (model, graph, nodes, tensors) and checks that they nest properly, that every
// dimension and every product of them is bounded, that weights are as long as their shape tells and inside the file, and
// that strides, kernels and the like are sizes. `name` stands in messages. Throws UserError.
void CheckOnnx(std::string_view bytes, const std::string& name);

}  // namespace ed3r::perception
