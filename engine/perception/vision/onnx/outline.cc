#include "engine/perception/vision/onnx/outline.h"

#include <fmt/format.h>

#include "engine/core/files/protobuf.h"
#include "engine/perception/vision/onnx/fields.h"

namespace ed3r::perception {
namespace {

bool HoldsGraphs(std::string_view attribute, const std::string& name) {
  bool found = false;
  ForEachField(attribute, name, [&](const ProtobufField& field) {
    found = found || field.number == onnx::kAttributeGraph || field.number == onnx::kAttributeGraphs;
  });
  return found;
}

OnnxStep StepOf(std::string_view bytes, const std::string& name) {
  OnnxStep step;
  ForEachField(bytes, name, [&](const ProtobufField& field) {
    if (!field.IsBytes()) return;
    if (field.number == onnx::kNodeInput) step.inputs.emplace_back(field.bytes);
    if (field.number == onnx::kNodeOutput) step.outputs.emplace_back(field.bytes);
    if (field.number == onnx::kNodeName) step.name = field.bytes;
    if (field.number == onnx::kNodeOp) step.op = field.bytes;
    if (field.number == onnx::kNodeDomain) step.domain = field.bytes;
    if (field.number == onnx::kNodeAttribute && HoldsGraphs(field.bytes, name)) step.has_graphs = true;
  });
  return step;
}

OnnxDim DimOf(std::string_view bytes, const std::string& name) {
  OnnxDim dim;
  ForEachField(bytes, name, [&](const ProtobufField& field) {
    if (field.number == onnx::kDimValue) dim.size = static_cast<std::int64_t>(field.value);
    if (dim.size == onnx::kOpenSide) dim.size = 0;
    if (field.number == onnx::kDimName && field.IsBytes()) dim.name = field.bytes;
  });
  return dim;
}

void ReadTensorType(std::string_view bytes, const std::string& name, OnnxValue& value) {
  ForEachField(bytes, name, [&](const ProtobufField& field) {
    if (field.number == onnx::kTensorElement) value.type = field.value;
    if (field.number != onnx::kTensorShape || !field.IsBytes()) return;
    value.has_shape = true;
    ForEachField(field.bytes, name, [&](const ProtobufField& dim) {
      if (dim.number == onnx::kShapeDim && dim.IsBytes()) value.dims.push_back(DimOf(dim.bytes, name));
    });
  });
}

}  // namespace

std::string OnnxValue::ShapeText() const {
  if (!has_shape) return "?";
  std::vector<std::string> sides;
  for (const OnnxDim& dim : dims)
    sides.push_back(dim.size > 0 ? std::to_string(dim.size) : dim.name.empty() ? "?" : dim.name);
  return fmt::format("[{}]", fmt::join(sides, ", "));
}

std::string OnnxStep::Text() const {
  const std::string text = domain.empty() || domain == "ai.onnx" ? op : domain + "." + op;
  return name.empty() ? text : fmt::format("{} (node '{}')", text, name);
}

OnnxValue ParseOnnxValue(std::string_view bytes, const std::string& name) {
  OnnxValue value;
  ForEachField(bytes, name, [&](const ProtobufField& field) {
    if (!field.IsBytes()) return;
    if (field.number == onnx::kValueName) value.name = field.bytes;
    if (field.number != onnx::kValueType) return;
    ForEachField(field.bytes, name, [&](const ProtobufField& kind) {
      if (kind.number == onnx::kTypeTensor && kind.IsBytes()) ReadTensorType(kind.bytes, name, value);
    });
  });
  return value;
}

OnnxOutline OutlineOf(std::string_view bytes, const std::string& name) {
  OnnxOutline outline;
  ForEachField(bytes, name, [&](const ProtobufField& model) {
    if (model.number != onnx::kGraph || !model.IsBytes()) return;
    ForEachField(model.bytes, name, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      if (field.number == onnx::kNode) outline.steps.push_back(StepOf(field.bytes, name));
      if (field.number == onnx::kInitializer) outline.weights.insert(onnx::TensorName(field.bytes, name));
      if (field.number == onnx::kInput) outline.inputs.push_back(ParseOnnxValue(field.bytes, name));
      if (field.number == onnx::kOutput) outline.outputs.push_back(ParseOnnxValue(field.bytes, name));
    });
  });
  std::erase_if(outline.inputs, [&](const OnnxValue& input) { return outline.weights.contains(input.name); });
  return outline;
}

}  // namespace ed3r::perception
