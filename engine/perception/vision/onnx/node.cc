#include "engine/perception/vision/onnx/node.h"

#include <fmt/format.h>

#include <cstring>

#include "engine/core/files/protobuf.h"
#include "engine/perception/vision/onnx/fields.h"

namespace ed3r::perception {
namespace {

template <class Number, class To>
void AppendRaw(std::string_view bytes, std::vector<To>& numbers) {
  for (std::size_t i = 0; i + sizeof(Number) <= bytes.size(); i += sizeof(Number)) {
    Number number{};
    std::memcpy(&number, bytes.data() + i, sizeof number);
    numbers.push_back(static_cast<To>(number));
  }
}

// What the field of an attribute gives it; nothing for its name and the like.
OnnxHeld HeldIn(const ProtobufField& field) {
  const bool number = field.wire == ProtobufField::Wire::kNumber;
  switch (field.number) {
    case onnx::kAttributeFloat:
      return field.wire == ProtobufField::Wire::kFixed32 ? OnnxHeld::kFloat : OnnxHeld::kElse;
    case onnx::kAttributeInt:
      return number ? OnnxHeld::kInt : OnnxHeld::kElse;
    case onnx::kAttributeInts:
      return number || field.IsBytes() ? OnnxHeld::kInts : OnnxHeld::kElse;
    case onnx::kAttributeText:
      return field.IsBytes() ? OnnxHeld::kText : OnnxHeld::kElse;
    case onnx::kAttributeTensor:
      return field.IsBytes() ? OnnxHeld::kTensor : OnnxHeld::kElse;
    case onnx::kAttributeGraph:
    case onnx::kAttributeFloats:
    case onnx::kAttributeTexts:
    case onnx::kAttributeTensors:
    case onnx::kAttributeGraphs:
      return OnnxHeld::kElse;
    default:
      return OnnxHeld::kNothing;
  }
}

void ReadAttribute(std::string_view bytes, const std::string& name, OnnxNode& node) {
  std::string key;
  OnnxAttribute attribute;
  ForEachField(bytes, name, [&](const ProtobufField& field) {
    if (field.number == onnx::kAttributeName && field.IsBytes()) key = field.bytes;
    const OnnxHeld held = HeldIn(field);
    if (held == OnnxHeld::kNothing) return;
    const bool mixed = attribute.held != OnnxHeld::kNothing && attribute.held != held;
    attribute.held = mixed ? OnnxHeld::kElse : held;
    if (held == OnnxHeld::kFloat) {
      std::vector<float> number;
      AppendRaw<float>(field.bytes, number);
      attribute.number = static_cast<double>(number.at(0));
    }
    if (held == OnnxHeld::kInt)
      attribute.number = static_cast<double>(static_cast<std::int64_t>(field.value));
    if (held == OnnxHeld::kText) attribute.text = field.bytes;
    if (held == OnnxHeld::kInts) onnx::Append(field, name, attribute.numbers);
  });
  node.attributes[key] = std::move(attribute);
}

}  // namespace

std::vector<std::string> OnnxAttribute::Values() const {
  if (!text.empty()) return {text};
  if (numbers.empty()) return {fmt::format("{}", number)};
  std::vector<std::string> values;
  for (const std::int64_t value : numbers) values.push_back(std::to_string(value));
  return values;
}

double OnnxNode::Number(const std::string& attribute, double otherwise) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() ? otherwise : found->second.number;
}

std::vector<std::int64_t> OnnxNode::Numbers(const std::string& attribute) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() ? std::vector<std::int64_t>{} : found->second.numbers;
}

std::string OnnxNode::Word(const std::string& attribute, const std::string& otherwise) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() ? otherwise : found->second.text;
}

std::string OnnxNode::Text() const {
  return fmt::format("{}{} (node '{}')", domain.empty() || domain == "ai.onnx" ? "" : domain + ".", op, name);
}

OnnxNode NodeOf(std::string_view bytes, const std::string& name) {
  OnnxNode node;
  ForEachField(bytes, name, [&](const ProtobufField& field) {
    if (!field.IsBytes()) return;
    if (field.number == onnx::kNodeOp) node.op = field.bytes;
    if (field.number == onnx::kNodeDomain) node.domain = field.bytes;
    if (field.number == onnx::kNodeName) node.name = field.bytes;
    if (field.number == onnx::kNodeOutput) node.outputs.emplace_back(field.bytes);
    if (field.number == onnx::kNodeInput) node.inputs.emplace_back(field.bytes);
    if (field.number == onnx::kNodeAttribute) ReadAttribute(field.bytes, name, node);
  });
  return node;
}

OnnxConstant ConstantOf(std::string_view tensor, const std::string& name) {
  constexpr std::int64_t kMost = 64;
  OnnxConstant constant;
  std::string_view raw;
  std::int64_t elements = 1;
  ForEachField(tensor, name, [&](const ProtobufField& field) {
    if (field.number == onnx::kType) constant.type = field.value;
    if (field.number == onnx::kDims) onnx::Append(field, name, constant.sides);
    if (field.number == onnx::kRaw && field.IsBytes()) raw = field.bytes;
  });
  for (const std::int64_t side : constant.sides) elements *= side;
  if (elements > kMost) return constant;
  ForEachField(tensor, name, [&](const ProtobufField& field) {
    if (field.number == onnx::kFloats) AppendRaw<float>(field.bytes, constant.floats);
    if (field.number == onnx::kInt64s || field.number == onnx::kInt32s)
      onnx::Append(field, name, constant.whole);
  });
  if (constant.type == onnx::kFloat) AppendRaw<float>(raw, constant.floats);
  if (constant.type == onnx::kInt64) AppendRaw<std::int64_t>(raw, constant.whole);
  if (constant.type == onnx::kInt32) AppendRaw<std::int32_t>(raw, constant.whole);
  if (std::ssize(constant.floats) != elements) constant.floats.clear();
  if (std::ssize(constant.whole) != elements) constant.whole.clear();
  return constant;
}

}  // namespace ed3r::perception
