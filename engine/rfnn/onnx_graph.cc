#include "engine/rfnn/onnx_graph.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/core/check.h"
#include "engine/core/files/protobuf.h"
#include "engine/core/sha256.h"

namespace ed3r::rfnn {
namespace {

static_assert(std::endian::native == std::endian::little, "tensors are little-endian");

constexpr std::uint64_t kMostValues = 1 << 26;
constexpr std::uint64_t kFloatType = 1;

// Field numbers of onnx.proto.
enum ModelField { kIrVersion = 1, kProducer = 2, kGraph = 7, kOpset = 8, kMetadata = 14 };
enum GraphField { kNode = 1, kGraphName = 2, kInitializer = 5, kGraphInput = 11, kGraphOutput = 12 };
enum NodeField { kNodeInput = 1, kNodeOutput = 2, kNodeName = 3, kNodeOp = 4, kNodeAttribute = 5 };
enum AttributeField { kAttributeName = 1, kAttributeFloat = 2, kAttributeInt = 3, kAttributeType = 20 };
enum TensorField { kDims = 1, kDataType = 2, kFloatData = 4, kTensorName = 8, kRawData = 9 };
enum PairField { kKey = 1, kValue = 2 };

float FloatOf(std::string_view bytes) {
  float value = 0;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

void AppendFloats(std::string_view raw, std::vector<float>& values) {
  for (; raw.size() >= sizeof(float); raw.remove_prefix(sizeof(float))) values.push_back(FloatOf(raw));
}

class Parser {
 public:
  explicit Parser(const std::string& name) : name_(name) {}

  OnnxGraph Model(std::string_view bytes) {
    bool found = false;
    Each(bytes, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      if (field.number == kGraph) found = true, Graph(field.bytes);
      if (field.number == kMetadata) graph_.metadata.insert(Pair(field.bytes));
    });
    if (!found) Refuse("is no ONNX network: it has no graph");
    std::erase_if(graph_.inputs, [&](const std::string& input) { return graph_.tensors.contains(input); });
    return std::move(graph_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  template <class Visit>
  void Each(std::string_view bytes, Visit visit) const {
    ForEachField(bytes, name_, visit);
  }

  std::pair<std::string, std::string> Pair(std::string_view bytes) const {
    std::pair<std::string, std::string> pair;
    Each(bytes, [&](const ProtobufField& field) {
      if (field.IsBytes() && field.number == kKey) pair.first = field.bytes;
      if (field.IsBytes() && field.number == kValue) pair.second = field.bytes;
    });
    return pair;
  }

  void Graph(std::string_view bytes) {
    Each(bytes, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      if (field.number == kNode) graph_.nodes.push_back(Node(field.bytes));
      if (field.number == kInitializer) Tensor(field.bytes);
      if (field.number == kGraphInput) graph_.inputs.push_back(Pair(field.bytes).first);
      if (field.number == kGraphOutput) graph_.outputs.push_back(Pair(field.bytes).first);
    });
  }

  OnnxNode Node(std::string_view bytes) const {
    OnnxNode node;
    Each(bytes, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      if (field.number == kNodeInput) node.inputs.emplace_back(field.bytes);
      if (field.number == kNodeOutput) node.outputs.emplace_back(field.bytes);
      if (field.number == kNodeName) node.name = field.bytes;
      if (field.number == kNodeOp) node.op = field.bytes;
      if (field.number == kNodeAttribute) Attribute(field.bytes, node);
    });
    return node;
  }

  void Attribute(std::string_view bytes, OnnxNode& node) const {
    std::string name;
    double number = 0;
    Each(bytes, [&](const ProtobufField& field) {
      if (field.number == kAttributeName && field.IsBytes()) name = field.bytes;
      if (field.number == kAttributeFloat && field.wire == ProtobufField::Wire::kFixed32)
        number = FloatOf(field.bytes);
      if (field.number == kAttributeInt && field.wire == ProtobufField::Wire::kNumber)
        number = static_cast<double>(static_cast<std::int64_t>(field.value));
    });
    node.numbers[name] = number;
  }

  void Tensor(std::string_view bytes) {
    OnnxTensor tensor;
    std::string name;
    std::uint64_t type = 0;
    Each(bytes, [&](const ProtobufField& field) {
      if (field.number == kDims) Dims(field, tensor.dims);
      if (field.number == kDataType) type = field.value;
      if (field.number == kTensorName && field.IsBytes()) name = field.bytes;
      if (field.number == kFloatData || field.number == kRawData) AppendFloats(field.bytes, tensor.values);
    });
    if (type != kFloatType) return;  // shapes and the like; a node that needs it is refused
    std::uint64_t values = 1;
    for (const std::int64_t dim : tensor.dims) {
      if (dim < 1 || static_cast<std::uint64_t>(dim) > kMostValues / values)
        Refuse(fmt::format("tensor '{}' has the shape [{}]", name, fmt::join(tensor.dims, ", ")));
      values *= static_cast<std::uint64_t>(dim);
    }
    if (tensor.values.size() != values)
      Refuse(fmt::format("tensor '{}' has {} values, and its shape tells {}", name, tensor.values.size(),
                         values));
    graph_.tensors[name] = std::move(tensor);
  }

  // Numbers stand one by one or packed.
  void Dims(const ProtobufField& field, std::vector<std::int64_t>& dims) const {
    constexpr std::size_t kMostDims = 16;
    std::string_view packed = field.IsBytes() ? field.bytes : std::string_view();
    if (field.wire == ProtobufField::Wire::kNumber) dims.push_back(static_cast<std::int64_t>(field.value));
    while (!packed.empty() && dims.size() <= kMostDims)
      dims.push_back(static_cast<std::int64_t>(TakeVarint(packed, name_)));
    if (dims.size() > kMostDims) Refuse("has a tensor of more than 16 dimensions");
  }

  const std::string& name_;
  OnnxGraph graph_;
};

std::string TensorBytes(const std::string& name, const OnnxTensor& tensor) {
  ProtobufWriter writer;
  for (const std::int64_t dim : tensor.dims) writer.Number(kDims, static_cast<std::uint64_t>(dim));
  writer.Number(kDataType, kFloatType).Bytes(kTensorName, name);
  writer.Bytes(kRawData,
               {reinterpret_cast<const char*>(tensor.values.data()), tensor.values.size() * sizeof(float)});
  return writer.bytes();
}

std::string NodeBytes(const OnnxNode& node) {
  constexpr std::uint64_t kIntAttribute = 2;
  ProtobufWriter writer;
  for (const std::string& input : node.inputs) writer.Bytes(kNodeInput, input);
  for (const std::string& output : node.outputs) writer.Bytes(kNodeOutput, output);
  writer.Bytes(kNodeName, node.name).Bytes(kNodeOp, node.op);
  for (const auto& [name, number] : node.numbers) {
    ProtobufWriter attribute;
    attribute.Bytes(kAttributeName, name).Number(kAttributeInt, static_cast<std::uint64_t>(number));
    attribute.Number(kAttributeType, kIntAttribute);
    writer.Bytes(kNodeAttribute, attribute.bytes());
  }
  return writer.bytes();
}

// A ValueInfo of floats [n, width].
std::string ValueBytes(const std::string& name, int width) {
  constexpr std::uint32_t kName = 1, kType = 2, kTensorType = 1, kElement = 1, kShape = 2, kDim = 1,
                          kDimValue = 1, kDimName = 2;
  ProtobufWriter rows, columns, shape, tensor, type, value;
  rows.Bytes(kDimName, "n");
  columns.Number(kDimValue, static_cast<std::uint64_t>(width));
  shape.Bytes(kDim, rows.bytes()).Bytes(kDim, columns.bytes());
  tensor.Number(kElement, kFloatType).Bytes(kShape, shape.bytes());
  type.Bytes(kTensorType, tensor.bytes());
  value.Bytes(kName, name).Bytes(kType, type.bytes());
  return value.bytes();
}

}  // namespace

OnnxGraph ParseOnnxGraph(std::string_view bytes, const std::string& name) {
  return Parser(name).Model(bytes);
}

std::string OnnxGraphBytes(const OnnxGraph& graph, int features, const std::string& graph_name, int outputs) {
  constexpr std::uint64_t kIr = 7, kOpsetVersion = 13;
  constexpr std::uint32_t kVersion = 2;
  ProtobufWriter body;
  for (const OnnxNode& node : graph.nodes) body.Bytes(kNode, NodeBytes(node));
  body.Bytes(kGraphName, graph_name);
  for (const auto& [name, tensor] : graph.tensors) body.Bytes(kInitializer, TensorBytes(name, tensor));
  body.Bytes(kGraphInput, ValueBytes(graph.inputs.front(), features));
  body.Bytes(kGraphOutput, ValueBytes(graph.outputs.front(), outputs));
  ProtobufWriter opset, model;
  opset.Number(kVersion, kOpsetVersion);
  model.Number(kIrVersion, kIr)
      .Bytes(kProducer, "ed3r")
      .Bytes(kGraph, body.bytes())
      .Bytes(kOpset, opset.bytes());
  for (const auto& [key, value] : graph.metadata) {
    ProtobufWriter pair;
    pair.Bytes(kKey, key).Bytes(kValue, value);
    model.Bytes(kMetadata, pair.bytes());
  }
  return model.bytes();
}

namespace {

constexpr char kSealKey[] = "ed3r.sha256";

std::string SealOf(const OnnxGraph& graph) {
  Sha256 sha;
  const auto text = [&](const std::string& part) { sha.Update(fmt::format("{}:{}", part.size(), part)); };
  const auto texts = [&](const std::vector<std::string>& parts) {
    sha.Update(fmt::format("{} ", parts.size()));
    for (const std::string& part : parts) text(part);
  };
  texts(graph.inputs);
  texts(graph.outputs);
  for (const OnnxNode& node : graph.nodes) {
    text(node.op);
    texts(node.inputs);
    texts(node.outputs);
    for (const auto& [attribute, number] : node.numbers) text(fmt::format("{} {}", attribute, number));
  }
  for (const auto& [tensor, held] : graph.tensors) {
    text(fmt::format("{} {}", tensor, fmt::join(held.dims, " ")));
    sha.Update(held.values.data(), held.values.size() * sizeof(float));
  }
  for (const auto& [key, value] : graph.metadata)
    if (key != kSealKey) text(fmt::format("{} {}", key, value));
  return sha.Hex();
}

}  // namespace

void SealOnnx(OnnxGraph& graph) { graph.metadata[kSealKey] = SealOf(graph); }

void CheckOnnxSeal(const OnnxGraph& graph, const std::string& name) {
  const auto found = graph.metadata.find(kSealKey);
  if (found != graph.metadata.end() && found->second != SealOf(graph))
    throw UserError(
        fmt::format("{}: what it computes by does not match its metadata '{}': it is damaged, or was changed "
                    "since ed3r wrote it; write it again, or take that entry out where the change was meant",
                    name, kSealKey));
}

}  // namespace ed3r::rfnn
