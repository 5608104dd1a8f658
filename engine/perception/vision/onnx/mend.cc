#include "engine/perception/vision/onnx/mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "engine/core/check.h"
#include "engine/core/files/protobuf.h"
#include "engine/perception/vision/onnx/fields.h"

namespace ed3r::perception {
namespace {

// OpenCV puts one step in the place of several that look like a softmax, a norm, a batch normalization, a swish, a celu or
// a mish, and goes by the operators: not by whether the operands are those that the one step would take. Every pattern that
// it looks for leads over an edge out of one of these.
const std::set<std::string> kJoined = {"Elu", "Exp", "HardSigmoid", "ReduceL2", "Sqrt", "Tanh"};

class Mender {
 public:
  Mender(std::string_view node, std::size_t rank, const OnnxSurroundings& around, const std::string& name)
      : node_(node), rank_(rank), around_(around), name_(name), step_(NodeOf(node, name)) {}

  std::vector<std::string> Mended() const {
    if (step_.op == "Gemm") return Gemm();
    if (kJoined.contains(step_.op)) return Apart(OneNode());
    return {OneNode()};
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: operator {} {}", name_, step_.Text(), why));
  }

  std::string OneNode() const {
    if (step_.op == "Clip" && step_.inputs.size() > 1) return Clip();
    if (step_.op.ends_with("Softmax") && around_.opset >= 13 && !step_.Has("axis"))
      return std::string(node_) + LastAxis();
    if (step_.op == "Split" && step_.inputs.size() > 1) return WithList("split");
    if (step_.op.starts_with("Reduce") && step_.inputs.size() > 1) return WithList("axes");
    if (step_.op == "Squeeze") return Squeeze();
    if (step_.op == "Resize" && step_.Word("mode", "") == "linear" &&
        !step_.Has("coordinate_transformation_mode"))
      return std::string(node_) + HalfPixel();
    if (step_.op == "InstanceNormalization" && !step_.Has("epsilon"))
      return std::string(node_) + NumberAttribute("epsilon", 1e-5F);
    if (step_.op == "LeakyRelu" && !step_.Has("alpha"))
      return std::string(node_) + NumberAttribute("alpha", 0.01F);
    return std::string(node_);
  }

  // With an Identity behind it, so that what follows is no longer taken for the rest of a pattern.
  std::vector<std::string> Apart(const std::string& node) const {
    const std::string apart = step_.outputs.at(0) + " apart";
    ProtobufWriter step, identity;
    ForEachField(node, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kNodeOutput)
        step.Bytes(onnx::kNodeOutput, apart);
      else
        step.Copy(field);
    });
    identity.Bytes(onnx::kNodeInput, apart).Bytes(onnx::kNodeOutput, step_.outputs.at(0));
    identity.Bytes(onnx::kNodeName, apart).Bytes(onnx::kNodeOp, "Identity");
    return {step.bytes(), identity.bytes()};
  }

  static std::string LastAxis() {
    ProtobufWriter attribute, field;
    attribute.Bytes(onnx::kAttributeName, "axis").Number(onnx::kAttributeInt, ~std::uint64_t{0});
    attribute.Number(onnx::kAttributeType, onnx::kTypeOfInt);
    return field.Bytes(onnx::kNodeAttribute, attribute.bytes()).bytes();
  }

  std::vector<std::string> Gemm() const {
    if (step_.Number("transB", 0) == 1) return {std::string(node_)};
    const std::string turned = step_.inputs[1] + "_turned_for_" + step_.name;
    ProtobufWriter transpose, permutation, gemm;
    permutation.Bytes(onnx::kAttributeName, "perm").Number(onnx::kAttributeInts, 1);
    permutation.Number(onnx::kAttributeInts, 0).Number(onnx::kAttributeType, onnx::kTypeOfInts);
    transpose.Bytes(onnx::kNodeInput, step_.inputs[1]).Bytes(onnx::kNodeOutput, turned);
    transpose.Bytes(onnx::kNodeName, turned).Bytes(onnx::kNodeOp, "Transpose");
    transpose.Bytes(onnx::kNodeAttribute, permutation.bytes());
    int input = 0;
    ForEachField(node_, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kNodeInput && input++ == 1)
        gemm.Bytes(onnx::kNodeInput, turned);
      else if (field.number != onnx::kNodeAttribute)
        gemm.Copy(field);
    });
    ProtobufWriter as_it_is;
    as_it_is.Bytes(onnx::kAttributeName, "transB").Number(onnx::kAttributeInt, 1);
    as_it_is.Number(onnx::kAttributeType, onnx::kTypeOfInt);
    gemm.Bytes(onnx::kNodeAttribute, as_it_is.bytes());
    return {transpose.bytes(), gemm.bytes()};
  }

  // Without the inputs behind the first, and where it is to be bare without its attributes.
  std::string WithFirstInput(bool bare = false) const {
    ProtobufWriter node;
    int input = 0;
    ForEachField(node_, name_, [&](const ProtobufField& field) {
      if (bare && field.number == onnx::kNodeAttribute) return;
      if (field.number != onnx::kNodeInput || input++ == 0) node.Copy(field);
    });
    return node.bytes();
  }

  // The second input as an attribute, as of old.
  std::string WithList(const std::string& attribute) const {
    if (step_.inputs[1].empty()) return WithFirstInput();
    const std::vector<std::int64_t>& list = around_.constants.at(step_.inputs[1]).whole;
    return list.empty() ? WithFirstInput() : WithFirstInput() + ListAttribute(attribute, list);
  }

  static std::string HalfPixel() {
    ProtobufWriter attribute, field;
    attribute.Bytes(onnx::kAttributeName, "coordinate_transformation_mode");
    attribute.Bytes(onnx::kAttributeText, "half_pixel").Number(onnx::kAttributeType, onnx::kTypeOfText);
    return field.Bytes(onnx::kNodeAttribute, attribute.bytes()).bytes();
  }

  std::string Squeeze() const {
    std::vector<std::int64_t> axes =
        step_.HasInput(1) ? around_.constants.at(step_.inputs[1]).whole : step_.Numbers("axes");
    for (std::int64_t& axis : axes)
      if (axis < 0) axis += static_cast<std::int64_t>(rank_);
    return WithFirstInput(true) + ListAttribute("axes", axes);
  }

  static std::string ListAttribute(const std::string& name, const std::vector<std::int64_t>& list) {
    ProtobufWriter numbers, field;
    numbers.Bytes(onnx::kAttributeName, name);
    for (const std::int64_t number : list)
      numbers.Number(onnx::kAttributeInts, static_cast<std::uint64_t>(number));
    numbers.Number(onnx::kAttributeType, onnx::kTypeOfInts);
    return field.Bytes(onnx::kNodeAttribute, numbers.bytes()).bytes();
  }

  std::string Clip() const {
    std::string text = WithFirstInput();
    const char* const names[] = {"min", "max"};
    for (std::size_t i = 1; i < std::min<std::size_t>(step_.inputs.size(), 3); ++i) {
      if (step_.inputs[i].empty()) continue;
      const std::vector<float>& bound = around_.constants.at(step_.inputs[i]).floats;
      if (bound.size() != 1)
        Refuse(fmt::format("has the bound '{}' of several numbers; allowed: one", step_.inputs[i]));
      text += NumberAttribute(names[i - 1], bound[0]);
    }
    return text;
  }

  // As a field of the node.
  static std::string NumberAttribute(const std::string& name, float value) {
    ProtobufWriter attribute, field;
    attribute.Bytes(onnx::kAttributeName, name).Float(onnx::kAttributeFloat, value);
    attribute.Number(onnx::kAttributeType, onnx::kTypeOfFloat);
    return field.Bytes(onnx::kNodeAttribute, attribute.bytes()).bytes();
  }

  std::string_view node_;
  std::size_t rank_;
  const OnnxSurroundings& around_;
  const std::string& name_;
  OnnxNode step_;
};

}  // namespace

std::vector<std::string> Mended(std::string_view node, std::size_t rank, const OnnxSurroundings& around,
                                const std::string& name) {
  return Mender(node, rank, around, name).Mended();
}

}  // namespace ed3r::perception
