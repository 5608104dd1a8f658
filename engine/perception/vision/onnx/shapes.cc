#include "engine/perception/vision/onnx/shapes.h"

#include <algorithm>

#include "engine/perception/vision/onnx/shape_step.h"

namespace ed3r::perception {
namespace {

class Whole : public ShapeStep {
 public:
  explicit Whole(const ShapeStep& step) : ShapeStep(step) {}

  std::vector<std::int64_t> Made() const {
    const std::string& op = node_.op;
    if (op == "Shape") return X();
    std::vector<std::int64_t> first = Numbers(0, "");
    if (op == "Cast" || op == "Unsqueeze") return first;
    if (op == "Concat") {
      for (std::size_t i = 1; i < node_.inputs.size(); ++i)
        for (const std::int64_t number : Numbers(i, "")) first.push_back(number);
      return first;
    }
    const std::vector<std::int64_t> second = Numbers(1, "");
    const auto size = std::ssize(first);
    std::vector<std::int64_t> made;
    if (op == "Gather") {
      for (const std::int64_t at : second) {
        if (at < -size || at >= size)
          Refuse(fmt::format("takes number {} of {}", at, size), "those that there are");
        made.push_back(first[static_cast<std::size_t>(at < 0 ? at + size : at)]);
      }
      return made;
    }
    if (op == "Slice") {
      const std::vector<std::int64_t> ends = Numbers(2, "");
      if (second.size() != 1 || ends.size() != 1) Refuse("has several starts or ends", "one");
      const auto clamped = [&](std::int64_t at) {
        return std::clamp<std::int64_t>(at < 0 ? at + size : at, 0, size);
      };
      for (std::int64_t i = clamped(second[0]); i < clamped(ends[0]); ++i)
        made.push_back(first[static_cast<std::size_t>(i)]);
      return made;
    }
    if (first.size() != 1 || second.size() != 1) Refuse("takes several whole numbers", "one and one");
    if (op == "Div" && (second[0] <= 0 || first[0] < 0))
      Refuse("divides by 0, or negative numbers", "positive ones");
    return {op == "Div" ? first[0] / second[0] : first[0] * second[0]};
  }
};

}  // namespace

std::vector<std::int64_t> WholeNumbers(const ShapeStep& step) { return Whole(step).Made(); }

// Sizes that were made float have quotients that are not whole.
void OnnxShapes::FollowFloats(const OnnxNode& node) {
  const bool floats = node.op == "Cast"
                          ? node.Number("to", 0) == static_cast<double>(onnx::kFloat)
                          : std::any_of(node.inputs.begin(), node.inputs.end(),
                                        [&](const auto& input) { return floats_.contains(input); });
  if (floats && node.op == "Div")
    throw UserError(fmt::format("{}: operator {} divides sizes that were made float; allowed: int64", name_,
                                node.Text()));
  if (floats) floats_.insert(node.outputs.at(0));
}

void OnnxShapes::Add(const OnnxNode& node) {
  const ShapeStep step(node, around_, sides_, whole_, name_);
  const OnnxRule rule = RuleOf(node, step.Kinds(), around_.opset, name_);
  if (rule == OnnxRule::kNumbers) FollowFloats(node);
  if (rule == OnnxRule::kShape || rule == OnnxRule::kNumbers) whole_[node.outputs.at(0)] = WholeNumbers(step);
  std::vector<OnnxSides> outputs = ComputedSides(step, rule);
  if (outputs.empty()) outputs = ArrangedSides(step, rule);
  for (const OnnxSides& sides : outputs) step.CheckSize(sides);
  for (std::size_t i = 0; i < outputs.size() && i < node.outputs.size(); ++i)
    sides_[node.outputs[i]] = outputs[i];
}

OnnxSides OnnxShapes::Of(const std::string& value) const {
  const auto found = sides_.find(value);
  return found == sides_.end() ? OnnxSides{} : found->second;
}

}  // namespace ed3r::perception
