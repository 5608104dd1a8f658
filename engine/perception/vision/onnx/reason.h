// What OpenCV says of a model that it cannot read or run, in a user's words.
#pragma once

#include <string>
#include <string_view>

namespace ed3r::perception {

// Of a message as "Node [Foo@ai.onnx]:(onnx_node!n) parse error: ...", "operator Foo (node 'n') cannot be run ...".
// Without a node in it: the message's first line, without version and source file.
std::string ReasonOf(std::string_view opencv_message);

}  // namespace ed3r::perception
