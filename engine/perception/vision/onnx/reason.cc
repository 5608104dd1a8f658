#include "engine/perception/vision/onnx/reason.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace ed3r::perception {
namespace {

// "Conv@ai.onnx" as "Conv", "Op@com.mine" as "com.mine.Op".
std::string Operator(std::string_view text) {
  const std::size_t at = text.find('@');
  const std::string_view op = text.substr(0, at);
  const std::string_view domain = at == std::string_view::npos ? "ai.onnx" : text.substr(at + 1);
  return domain.empty() || domain == "ai.onnx" ? std::string(op) : fmt::format("{}.{}", domain, op);
}

// OpenCV's own prefixes of names.
std::string_view Node(std::string_view name) {
  for (const std::string_view prefix : {"onnx_node_output_0!", "onnx_node_output!", "onnx_node!"})
    if (name.starts_with(prefix)) return name.substr(prefix.size());
  return name;
}

// "> Node [Foo@ai.onnx]:(onnx_node!n) parse error: ..." of the importer, ' layer "n" of type "Foo"' of the layers.
bool FindNode(std::string_view message, std::string& op, std::string& node) {
  const std::size_t begin = message.find("Node [");
  if (begin != std::string_view::npos) {
    const std::size_t end = message.find("]:(", begin), close = message.find(')', end);
    if (end == std::string_view::npos || close == std::string_view::npos) return false;
    op = Operator(message.substr(begin + 6, end - begin - 6));
    node = Node(message.substr(end + 3, close - end - 3));
    return true;
  }
  const std::size_t type = message.find("of type \"");
  if (type == std::string_view::npos) return false;
  const std::string_view rest = message.substr(type + 9);
  op = rest.substr(0, rest.find('"'));
  return true;
}

// Without the version and the source file that stand before each of OpenCV's messages, and with the condition that some of
// them tell in lines of their own.
std::string Bare(std::string_view message) {
  const std::size_t error = message.rfind("error: (");
  const std::size_t end = error == std::string_view::npos ? error : message.find(") ", error);
  if (end != std::string_view::npos) message = message.substr(end + 2);
  std::string text;
  while (!message.empty()) {
    const std::size_t stop = std::min(message.find('\n'), message.size());
    std::string_view line = message.substr(0, stop);
    message.remove_prefix(std::min(stop + 1, message.size()));
    while (!line.empty() && (line.front() == '>' || line.front() == ' ')) line.remove_prefix(1);
    line = line.substr(0, line.find(" in function '"));
    if (line.empty() || line.starts_with("in function '")) continue;
    if (!text.empty()) text += ' ';
    text += line;
  }
  return text;
}

}  // namespace

std::string ReasonOf(std::string_view opencv_message) {
  std::string op, node;
  if (!FindNode(opencv_message, op, node))
    return fmt::format("is no model that OpenCV can run: {}", Bare(opencv_message));
  return fmt::format("operator {}{} cannot be run by OpenCV, or not with these inputs and attributes: {}", op,
                     node.empty() ? "" : fmt::format(" (node '{}')", node), Bare(opencv_message));
}

}  // namespace ed3r::perception
