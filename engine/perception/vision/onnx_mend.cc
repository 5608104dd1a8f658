#include "engine/perception/vision/onnx_mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>

#include "engine/core/check.h"
#include "engine/core/protobuf.h"
#include "engine/perception/vision/onnx_fields.h"

namespace ed3r {
namespace {

struct Attribute {
  double number = 0.0;  // of one number
  std::vector<std::int64_t> numbers;
};

// A node with its attributes that are numbers.
struct Step {
  std::string op, name;
  std::vector<std::string> inputs;
  std::map<std::string, Attribute> attributes;

  double Number(const std::string& attribute, double otherwise) const {
    const auto found = attributes.find(attribute);
    return found == attributes.end() ? otherwise : found->second.number;
  }
  bool Has(const std::string& attribute) const { return attributes.contains(attribute); }
};

class Mender {
 public:
  Mender(std::string_view node, std::string_view producer, const std::string& name)
      : node_(node), producer_(producer), name_(name) {
    ForEachField(node, name, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      if (field.number == onnx::kNodeOp) step_.op = field.bytes;
      if (field.number == onnx::kNodeName) step_.name = field.bytes;
      if (field.number == onnx::kNodeInput) step_.inputs.emplace_back(field.bytes);
      if (field.number == onnx::kNodeAttribute) ReadAttribute(field.bytes);
    });
  }

  std::vector<std::string> Mended() const {
    if (step_.op == "Gemm") return Gemm();
    if (step_.op == "AveragePool") CheckPadding();
    if (step_.op == "LeakyRelu" && !step_.Has("alpha")) return {std::string(node_) + Slope()};
    return {std::string(node_)};
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: operator {} (node '{}') {}", name_, step_.op, step_.name, why));
  }

  void ReadAttribute(std::string_view bytes) {
    std::string name;
    Attribute attribute;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kAttributeName && field.IsBytes()) name = field.bytes;
      if (field.number == onnx::kAttributeFloat && field.wire == ProtobufField::Wire::kFixed32) {
        float value = 0.0F;
        std::memcpy(&value, field.bytes.data(), sizeof value);
        attribute.number = static_cast<double>(value);
      }
      if (field.number == onnx::kAttributeInt)
        attribute.number = static_cast<double>(static_cast<std::int64_t>(field.value));
      if (field.number != onnx::kAttributeInts) return;
      if (!field.IsBytes()) attribute.numbers.push_back(static_cast<std::int64_t>(field.value));
      for (std::string_view packed = field.IsBytes() ? field.bytes : ""; !packed.empty();)
        attribute.numbers.push_back(static_cast<std::int64_t>(TakeVarint(packed, name_)));
    });
    step_.attributes[name] = std::move(attribute);
  }

  std::vector<std::string> Gemm() const {
    if (step_.Number("transA", 0) != 0) Refuse("has transA = 1; allowed: 0");
    if (step_.Number("alpha", 1) != 1 || (step_.inputs.size() > 2 && step_.Number("beta", 1) != 1))
      Refuse("has an alpha or a beta that is not 1; allowed: 1, the factors multiplied into the weights");
    if (step_.Number("transB", 0) == 1 || step_.inputs.size() < 2) return {std::string(node_)};
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

  void CheckPadding() const {
    const auto pads = step_.attributes.find("pads");
    if (pads == step_.attributes.end() ||
        std::all_of(pads->second.numbers.begin(), pads->second.numbers.end(),
                    [](std::int64_t pad) { return pad == 0; }))
      return;
    const bool counts = step_.Number("count_include_pad", 0) != 0, opencv_counts = producer_ == "pytorch";
    if (counts != opencv_counts)
      Refuse(
          fmt::format("has count_include_pad = {}, which OpenCV reads otherwise in a model of '{}'; allowed: "
                      "a Pad before "
                      "an AveragePool without pads",
                      counts ? 1 : 0, producer_));
  }

  // LeakyRelu's alpha, as the standard has it.
  static std::string Slope() {
    ProtobufWriter alpha, attribute;
    alpha.Bytes(onnx::kAttributeName, "alpha").Float(onnx::kAttributeFloat, 0.01F);
    alpha.Number(onnx::kAttributeType, onnx::kTypeOfFloat);
    return attribute.Bytes(onnx::kNodeAttribute, alpha.bytes()).bytes();
  }

  std::string_view node_, producer_;
  const std::string& name_;
  Step step_;
};

}  // namespace

std::vector<std::string> Mended(std::string_view node, std::string_view producer, const std::string& name) {
  return Mender(node, producer, name).Mended();
}

}  // namespace ed3r
