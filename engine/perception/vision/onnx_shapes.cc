#include "engine/perception/vision/onnx_shapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/vision/onnx_mend.h"

namespace ed3r::perception {
namespace {

using cv::dnn::MatShape;

constexpr char kPrefix[] = "onnx_node!";  // OpenCV's, before the names of steps

MatShape ShapeOf(const cv::dnn::Net& network, const MatShape& input, int layer) {
  std::vector<MatShape> in, out;
  network.getLayerShapes(input, layer, in, out);
  return out.empty() ? MatShape{} : out.front();
}

// OpenCV takes the larger operand for the first, and spreads the smaller one.
void CheckQuotient(const cv::dnn::Net& network, const MatShape& input, int second, const std::string& step,
                   const std::string& name) {
  const int first = network.getLayerId(std::string(kPrefix) + kFirstOperand + step);
  const MatShape of_second = ShapeOf(network, input, second);
  const MatShape of_first = first < 0 ? MatShape{} : ShapeOf(network, input, first);
  if (of_first == of_second || (first >= 0 && cv::dnn::total(of_first) > cv::dnn::total(of_second))) return;
  throw UserError(
      fmt::format("{}: operator {} divides [{}] by [{}], which OpenCV turns round; allowed: the larger one "
                  "divided by the smaller, or a Mul by the quotient of 1",
                  name, step, fmt::join(of_first, ", "), fmt::join(of_second, ", ")));
}

// "1 of Softmax (node 'x')": before opset 13 the sides from there on count as one.
void CheckFlattened(const cv::dnn::Net& network, const MatShape& input, int layer, const std::string& rest,
                    const std::string& name) {
  const MatShape shape = ShapeOf(network, input, layer);
  const int told = std::atoi(rest.c_str()), rank = static_cast<int>(shape.size());
  const int axis = std::clamp(told < 0 ? told + rank : told, 0, rank);
  const bool alike =
      std::all_of(shape.begin() + std::min(axis + 1, rank), shape.end(), [](int side) { return side == 1; });
  if (alike) return;
  throw UserError(fmt::format(
      "{}: operator {} is taken of [{}] from side {} on as one (opset below 13), which OpenCV does "
      "not; allowed: sides of 1 behind that, or a Flatten before",
      name, rest.substr(rest.find(" of ") + 4), fmt::join(shape, ", "), told));
}

}  // namespace

void CheckShapes(const cv::dnn::Net& network, const MatShape& input, const std::string& name) {
  const std::string second = std::string(kPrefix) + kSecondOperand,
                    flattened = std::string(kPrefix) + kFlattened;
  for (const std::string& layer : network.getLayerNames()) {
    const int id = network.getLayerId(layer);
    if (layer.starts_with(second)) CheckQuotient(network, input, id, layer.substr(second.size()), name);
    if (layer.starts_with(flattened))
      CheckFlattened(network, input, id, layer.substr(flattened.size()), name);
  }
}

}  // namespace ed3r::perception
