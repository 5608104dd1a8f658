#include "engine/perception/vision/onnx_mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>

#include "engine/core/check.h"
#include "engine/core/protobuf.h"
#include "engine/perception/vision/onnx_fields.h"

namespace ed3r::perception {
namespace {

struct Attribute {
  double number = 0.0;  // of one number
  std::vector<std::int64_t> numbers;
  std::string text;
};

// A node with its attributes that are numbers or words.
struct Step {
  std::string op, name;
  std::vector<std::string> inputs, outputs;
  std::map<std::string, Attribute> attributes;

  double Number(const std::string& attribute, double otherwise) const {
    const auto found = attributes.find(attribute);
    return found == attributes.end() ? otherwise : found->second.number;
  }
  bool Has(const std::string& attribute) const { return attributes.contains(attribute); }
};

class Mender {
 public:
  Mender(std::string_view node, const OnnxSurroundings& around, const std::string& name)
      : node_(node), around_(around), name_(name) {
    ForEachField(node, name, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      if (field.number == onnx::kNodeOp) step_.op = field.bytes;
      if (field.number == onnx::kNodeName) step_.name = field.bytes;
      if (field.number == onnx::kNodeOutput) step_.outputs.emplace_back(field.bytes);
      if (field.number == onnx::kNodeInput) step_.inputs.emplace_back(field.bytes);
      if (field.number == onnx::kNodeAttribute) ReadAttribute(field.bytes);
    });
  }

  std::vector<std::string> Mended() const {
    if (IsQuantised(step_.op))
      Refuse(
          "computes with quantised numbers, which OpenCV rounds and cuts off otherwise than the standard; "
          "allowed: the "
          "model of single or half precision, from before it was quantised");
    CheckWindow();
    if (step_.op == "Gemm") return Gemm();
    if (step_.op == "AveragePool") CheckPadding();
    if (step_.op == "Clip" && step_.inputs.size() > 1) return {Clip()};
    if (step_.op == "Div") {
      CheckQuotient();
      if (Computed(0) && Computed(1)) return WithNamedInputs({kFirstOperand, kSecondOperand});
    }
    if (step_.op.ends_with("Softmax") && around_.opset < 13 && Computed(0))
      return WithNamedInputs({fmt::format("{}{} of ", kFlattened, step_.Number("axis", 1))});
    if (step_.op == "Cast") CheckCast();
    if (step_.op == "Resize" && step_.Number("antialias", 0) != 0)
      Refuse("has antialias = 1, which OpenCV passes over; allowed: 0");
    if (step_.op.ends_with("Softmax") && around_.opset >= 13 && !step_.Has("axis"))
      return {std::string(node_) + LastAxis()};
    if (step_.op == "Split" && step_.inputs.size() > 1) return {WithList("split", "sizes")};
    if (step_.op.starts_with("Reduce")) return {Reduce()};
    if (step_.op == "LeakyRelu" && !step_.Has("alpha"))
      return {std::string(node_) + NumberAttribute("alpha", 0.01F)};
    return {std::string(node_)};
  }

 private:
  static bool IsQuantised(std::string_view op) {
    return op.starts_with("QLinear") || op.ends_with("QuantizeLinear") || op == "DequantizeLinear" ||
           op.ends_with("Integer");
  }

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
      if (field.number == onnx::kAttributeText && field.IsBytes()) attribute.text = field.bytes;
      if (field.number != onnx::kAttributeInts) return;
      if (!field.IsBytes()) attribute.numbers.push_back(static_cast<std::int64_t>(field.value));
      for (std::string_view packed = field.IsBytes() ? field.bytes : ""; !packed.empty();)
        attribute.numbers.push_back(static_cast<std::int64_t>(TakeVarint(packed, name_)));
    });
    step_.attributes[name] = std::move(attribute);
  }

  // Of convolutions and pools.
  void CheckWindow() const {
    const auto pad = step_.attributes.find("auto_pad");
    if (pad != step_.attributes.end() && pad->second.text == "SAME_LOWER")
      Refuse(
          "has auto_pad = SAME_LOWER, which OpenCV takes for SAME_UPPER; allowed: SAME_UPPER, or pads in "
          "numbers");
    const bool same = pad != step_.attributes.end() && pad->second.text.starts_with("SAME_");
    const auto dilations = step_.attributes.find("dilations");
    const bool dilated = dilations != step_.attributes.end() &&
                         std::any_of(dilations->second.numbers.begin(), dilations->second.numbers.end(),
                                     [](std::int64_t dilation) { return dilation != 1; });
    if (step_.op == "Conv" && dilated && same)
      Refuse("has dilations beside auto_pad, which OpenCV pads as without them; allowed: pads in numbers");
    if (step_.op == "ConvTranspose" && (dilated || same || step_.Has("output_shape")))
      Refuse(
          "has dilations, auto_pad or output_shape, which OpenCV passes over or reads otherwise there; "
          "allowed: dilations of 1, and pads and output_padding in numbers");
    if (step_.op.ends_with("Pool") && dilated)
      Refuse("has dilations, which OpenCV passes over in pools; allowed: 1");
  }

  // OpenCV takes the larger operand for the first.
  void CheckQuotient() const {
    if (step_.inputs.size() < 2 || around_.elements.contains(step_.inputs[1])) return;
    const auto first = around_.elements.find(step_.inputs[0]);
    if (first != around_.elements.end() && first->second > 1)
      Refuse(
          "divides a constant of several numbers by what is computed, which OpenCV turns round; allowed: one "
          "number, or a Mul by the quotient of 1");
  }

  void CheckCast() const {
    const auto to = static_cast<std::uint64_t>(step_.Number("to", 1));
    const bool real = to == onnx::kFloat || to == onnx::kFloat16 || to == onnx::kDouble;
    if (!real && Computed(0) && !around_.whole.contains(step_.inputs[0]))
      Refuse(fmt::format("casts to {}, and OpenCV cuts nothing off; allowed: float, or a Floor before",
                         onnx::TypeName(to)));
  }

  bool Computed(std::size_t input) const {
    return input < step_.inputs.size() && !around_.elements.contains(step_.inputs[input]);
  }

  // CheckShapes finds the inputs by these names.
  std::vector<std::string> WithNamedInputs(const std::vector<std::string>& names) const {
    std::vector<std::string> nodes;
    ProtobufWriter step;
    std::size_t input = 0;
    const std::string text =
        fmt::format("{} (output '{}')", step_.op, step_.outputs.empty() ? "" : step_.outputs.front());
    ForEachField(node_, name_, [&](const ProtobufField& field) {
      if (field.number != onnx::kNodeInput || input >= names.size()) {
        step.Copy(field);
        return;
      }
      const std::string named = names[input++] + text;
      ProtobufWriter identity;
      identity.Bytes(onnx::kNodeInput, field.bytes).Bytes(onnx::kNodeOutput, named);
      identity.Bytes(onnx::kNodeName, named).Bytes(onnx::kNodeOp, "Identity");
      nodes.push_back(identity.bytes());
      step.Bytes(onnx::kNodeInput, named);
    });
    nodes.push_back(step.bytes());
    return nodes;
  }

  static std::string LastAxis() {
    ProtobufWriter attribute, field;
    attribute.Bytes(onnx::kAttributeName, "axis").Number(onnx::kAttributeInt, ~std::uint64_t{0});
    attribute.Number(onnx::kAttributeType, onnx::kTypeOfInt);
    return field.Bytes(onnx::kNodeAttribute, attribute.bytes()).bytes();
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
    const bool counts = step_.Number("count_include_pad", 0) != 0,
               opencv_counts = around_.producer == "pytorch";
    if (counts != opencv_counts)
      Refuse(
          fmt::format("has count_include_pad = {}, which OpenCV reads otherwise in a model of '{}'; allowed: "
                      "a Pad before "
                      "an AveragePool without pads",
                      counts ? 1 : 0, around_.producer));
  }

  std::string WithFirstInput() const {
    ProtobufWriter node;
    int input = 0;
    ForEachField(node_, name_, [&](const ProtobufField& field) {
      if (field.number != onnx::kNodeInput || input++ == 0) node.Copy(field);
    });
    return node.bytes();
  }

  // The second input as an attribute, as of old.
  std::string WithList(const std::string& attribute, const std::string& what) const {
    if (step_.inputs[1].empty()) return WithFirstInput();
    const auto list = around_.lists.find(step_.inputs[1]);
    if (list == around_.lists.end())
      Refuse(
          fmt::format("has the {} '{}', which are no constants; allowed: constants", what, step_.inputs[1]));
    if (list->second.empty()) return WithFirstInput();
    ProtobufWriter numbers, field;
    numbers.Bytes(onnx::kAttributeName, attribute);
    for (const std::int64_t number : list->second)
      numbers.Number(onnx::kAttributeInts, static_cast<std::uint64_t>(number));
    numbers.Number(onnx::kAttributeType, onnx::kTypeOfInts);
    return WithFirstInput() + field.Bytes(onnx::kNodeAttribute, numbers.bytes()).bytes();
  }

  std::string Reduce() const {
    if (step_.Number("noop_with_empty_axes", 0) != 0 && !step_.Has("axes") &&
        (step_.inputs.size() < 2 || step_.inputs[1].empty()))
      Refuse("has noop_with_empty_axes = 1 and no axes; allowed: the axes told");
    return step_.inputs.size() > 1 ? WithList("axes", "axes") : std::string(node_);
  }

  std::string Clip() const {
    std::string text = WithFirstInput();
    const char* const names[] = {"min", "max"};
    for (std::size_t i = 1; i < std::min<std::size_t>(step_.inputs.size(), 3); ++i) {
      if (step_.inputs[i].empty()) continue;
      const auto bound = around_.bounds.find(step_.inputs[i]);
      if (bound == around_.bounds.end())
        Refuse(fmt::format("has the bound '{}', which is no constant number; allowed: constants",
                           step_.inputs[i]));
      text += NumberAttribute(names[i - 1], bound->second);
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
  const OnnxSurroundings& around_;
  const std::string& name_;
  Step step_;
};

}  // namespace

namespace {

// Of int64: one by one, packed, or raw.
std::vector<std::int64_t> WholeNumbers(std::string_view tensor, const std::string& name) {
  std::vector<std::int64_t> numbers;
  ForEachField(tensor, name, [&](const ProtobufField& field) {
    if (field.number == onnx::kInt64s && !field.IsBytes())
      numbers.push_back(static_cast<std::int64_t>(field.value));
    if (field.number == onnx::kInt64s && field.IsBytes())
      for (std::string_view packed = field.bytes; !packed.empty();)
        numbers.push_back(static_cast<std::int64_t>(TakeVarint(packed, name)));
    if (field.number != onnx::kRaw || !field.IsBytes()) return;
    for (std::size_t i = 0; i + sizeof(std::int64_t) <= field.bytes.size(); i += sizeof(std::int64_t)) {
      std::int64_t number = 0;
      std::memcpy(&number, field.bytes.data() + i, sizeof number);
      numbers.push_back(number);
    }
  });
  return numbers;
}

}  // namespace

void AddConstant(std::string_view tensor, const std::string& value, const std::string& name,
                 OnnxSurroundings& around) {
  std::uint64_t type = 0;
  std::string_view bytes;
  std::int64_t elements = 1;
  ForEachField(tensor, name, [&](const ProtobufField& field) {
    if (field.number == onnx::kType) type = field.value;
    if (field.number == onnx::kDims && !field.IsBytes()) elements *= static_cast<std::int64_t>(field.value);
    if (field.number == onnx::kDims && field.IsBytes())
      for (std::string_view packed = field.bytes; !packed.empty();)
        elements *= static_cast<std::int64_t>(TakeVarint(packed, name));
    if (field.number == onnx::kRaw || field.number == onnx::kFloats) bytes = field.bytes;
  });
  if (type == onnx::kInt64) around.lists[value] = WholeNumbers(tensor, name);
  around.elements[value] = elements;
  float bound = 0.0F;
  if (type != onnx::kFloat || bytes.size() != sizeof bound) return;
  std::memcpy(&bound, bytes.data(), sizeof bound);
  around.bounds[value] = bound;
}

std::vector<std::string> Mended(std::string_view node, const OnnxSurroundings& around,
                                const std::string& name) {
  return Mender(node, around, name).Mended();
}

}  // namespace ed3r::perception
