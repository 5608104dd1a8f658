#include "tests/vision/onnx_writer.h"

#include <bit>
#include <cstring>

#include "engine/core/files/protobuf.h"
#include "engine/perception/vision/onnx/fields.h"

namespace ed3r::test {
namespace {

std::string Message(std::uint32_t field, const std::string& bytes) {
  return ProtobufWriter().Bytes(field, bytes).bytes();
}

std::string Value(const std::string& name, const std::vector<std::int64_t>& dims, int type) {
  std::string shape;
  for (const std::int64_t dim : dims) {
    ProtobufWriter side;
    dim == kOpen ? side.Bytes(perception::onnx::kDimName, "open")
                 : side.Number(perception::onnx::kDimValue,
                               static_cast<std::uint64_t>(dim == kOpenAsNumber ? -1 : dim));
    shape += Message(perception::onnx::kShapeDim, side.bytes());
  }
  ProtobufWriter tensor;
  tensor.Number(perception::onnx::kTensorElement, static_cast<std::uint64_t>(type))
      .Bytes(perception::onnx::kTensorShape, shape);
  return Message(perception::onnx::kValueName, name) +
         Message(perception::onnx::kValueType, Message(perception::onnx::kTypeTensor, tensor.bytes()));
}

ProtobufWriter Tensor(const std::string& name, const std::vector<std::int64_t>& dims, int type) {
  ProtobufWriter tensor;
  for (const std::int64_t dim : dims) tensor.Number(perception::onnx::kDims, static_cast<std::uint64_t>(dim));
  tensor.Number(perception::onnx::kType, static_cast<std::uint64_t>(type))
      .Bytes(perception::onnx::kTensorName, name);
  return tensor;
}

template <class T>
std::string Raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string Pair(const std::string& key, const std::string& value) {
  return Message(perception::onnx::kPairKey, key) + Message(perception::onnx::kPairValue, value);
}

std::string AttributeBytes(const OnnxAttribute& attribute) {
  ProtobufWriter out;
  out.Bytes(perception::onnx::kAttributeName, attribute.name);
  if (const auto* number = std::get_if<std::int64_t>(&attribute.value))
    out.Number(perception::onnx::kAttributeInt, static_cast<std::uint64_t>(*number))
        .Number(perception::onnx::kAttributeType, 2);
  if (const auto* number = std::get_if<float>(&attribute.value))
    out.Float(perception::onnx::kAttributeFloat, *number).Number(perception::onnx::kAttributeType, 1);
  if (const auto* numbers = std::get_if<std::vector<std::int64_t>>(&attribute.value)) {
    for (const std::int64_t number : *numbers)
      out.Number(perception::onnx::kAttributeInts, static_cast<std::uint64_t>(number));
    out.Number(perception::onnx::kAttributeType, 7);
  }
  if (const auto* text = std::get_if<std::string>(&attribute.value))
    out.Bytes(perception::onnx::kAttributeText, *text).Number(perception::onnx::kAttributeType, 3);
  return out.bytes();
}

}  // namespace

std::uint16_t HalfBits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if (value == 0.0F) return 0;
  const auto exponent = static_cast<std::uint32_t>(static_cast<int>((bits >> 23) & 0xff) - 127 + 15);
  return static_cast<std::uint16_t>((bits >> 16 & 0x8000) | exponent << 10 | ((bits >> 13) & 0x3ff));
}

OnnxWriter& OnnxWriter::Input(const std::string& name, const std::vector<std::int64_t>& dims, int type) {
  inputs_ += Message(perception::onnx::kInput, Value(name, dims, type));
  return *this;
}

OnnxWriter& OnnxWriter::Output(const std::string& name, const std::vector<std::int64_t>& dims, int type) {
  outputs_ += Message(perception::onnx::kOutput, Value(name, dims, type));
  return *this;
}

OnnxWriter& OnnxWriter::Weights(const std::string& name, const std::vector<std::int64_t>& dims,
                                const std::vector<float>& values) {
  weights_ += Message(perception::onnx::kInitializer,
                      Tensor(name, dims, kFloat).Bytes(perception::onnx::kRaw, Raw(values)).bytes());
  return *this;
}

OnnxWriter& OnnxWriter::Halves(const std::string& name, const std::vector<std::int64_t>& dims,
                               const std::vector<float>& values, bool raw) {
  ProtobufWriter tensor = Tensor(name, dims, kFloat16);
  std::vector<std::uint16_t> halves;
  for (const float value : values) halves.push_back(HalfBits(value));
  if (raw) tensor.Bytes(perception::onnx::kRaw, Raw(halves));
  for (const std::uint16_t half : halves)
    if (!raw) tensor.Number(perception::onnx::kInt32s, half);
  weights_ += Message(perception::onnx::kInitializer, tensor.bytes());
  return *this;
}

OnnxWriter& OnnxWriter::Integers(const std::string& name, const std::vector<std::int64_t>& values) {
  weights_ +=
      Message(perception::onnx::kInitializer, Tensor(name, {static_cast<std::int64_t>(values.size())}, kInt64)
                                                  .Bytes(perception::onnx::kRaw, Raw(values))
                                                  .bytes());
  return *this;
}

OnnxWriter& OnnxWriter::Outside(const std::string& name, const std::vector<std::int64_t>& dims,
                                const std::string& file, const std::string& offset,
                                const std::string& length) {
  ProtobufWriter tensor = Tensor(name, dims, kFloat);
  tensor.Bytes(perception::onnx::kExternal, Pair("location", file));
  if (!offset.empty()) tensor.Bytes(perception::onnx::kExternal, Pair("offset", offset));
  if (!length.empty()) tensor.Bytes(perception::onnx::kExternal, Pair("length", length));
  tensor.Number(perception::onnx::kLocation, perception::onnx::kLiesOutside);
  weights_ += Message(perception::onnx::kInitializer, tensor.bytes());
  return *this;
}

OnnxWriter& OnnxWriter::Step(const std::string& op, const std::vector<std::string>& inputs,
                             const std::vector<std::string>& outputs,
                             const std::vector<OnnxAttribute>& attributes, const std::string& domain) {
  ProtobufWriter node;
  for (const std::string& input : inputs) node.Bytes(perception::onnx::kNodeInput, input);
  for (const std::string& output : outputs) node.Bytes(perception::onnx::kNodeOutput, output);
  node.Bytes(perception::onnx::kNodeName, "the " + op).Bytes(perception::onnx::kNodeOp, op);
  for (const OnnxAttribute& attribute : attributes)
    node.Bytes(perception::onnx::kNodeAttribute, AttributeBytes(attribute));
  if (!domain.empty()) node.Bytes(perception::onnx::kNodeDomain, domain);
  steps_ += Message(perception::onnx::kNode, node.bytes());
  return *this;
}

OnnxWriter& OnnxWriter::Producer(const std::string& name) {
  producer_ = name;
  return *this;
}

OnnxWriter& OnnxWriter::Opset(std::uint64_t version) {
  opset_ = version;
  return *this;
}

std::string OnnxWriter::Bytes() const {
  constexpr std::uint32_t kIrVersion = 1, kOpset = 8, kGraphName = 2, kVersion = 2;
  ProtobufWriter opset, model;
  opset.Number(kVersion, opset_);
  model.Number(kIrVersion, 7).Bytes(perception::onnx::kProducer, producer_);
  model.Bytes(perception::onnx::kGraph, steps_ + Message(kGraphName, "g") + weights_ + inputs_ + outputs_);
  return model.Bytes(kOpset, opset.bytes()).bytes();
}

void AddRedMinusBlue(OnnxWriter& writer, const std::string& colours) {
  writer.Weights("w", {3, 2}, {4, 0, 0, 0, -4, 0}).Weights("b", {2}, {0.5F, -0.25F});
  writer.Step("GlobalAveragePool", {colours}, {"means"})
      .Step("Flatten", {"means"}, {"flat"}, {{"axis", std::int64_t{1}}})
      .Step("Gemm", {"flat", "w", "b"}, {"y"});
}

OnnxWriter RedMinusBlue(const std::vector<std::int64_t>& input) {
  OnnxWriter writer;
  writer.Input("frame", input).Output("y", {1, 2});
  AddRedMinusBlue(writer, "frame");
  return writer;
}

}  // namespace ed3r::test
