#include "engine/perception/vision/onnx/rewrite.h"

#include <fmt/format.h>
#include <opencv2/core/cvdef.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <set>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/protobuf.h"
#include "engine/perception/vision/onnx/fields.h"
#include "engine/perception/vision/onnx/mend.h"
#include "engine/perception/vision/onnx/node.h"
#include "engine/perception/vision/onnx/shapes.h"

namespace ed3r::perception {
namespace {

std::uint64_t Widened(std::uint64_t type) { return type == onnx::kFloat16 ? onnx::kFloat : type; }

void AppendFloat(std::uint64_t half_bits, std::string& raw) {
  const auto value = static_cast<float>(cv::float16_t::fromBits(static_cast<ushort>(half_bits)));
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int i = 0; i < 4; ++i) raw += static_cast<char>(bits >> (8 * i));
}

std::string ValueBytes(const OnnxValue& value) {
  ProtobufWriter shape, tensor, type, whole;
  for (const OnnxDim& dim : value.dims) {
    ProtobufWriter side;
    if (dim.size > 0) side.Number(onnx::kDimValue, static_cast<std::uint64_t>(dim.size));
    if (dim.size == 0) side.Bytes(onnx::kDimName, dim.name);
    shape.Bytes(onnx::kShapeDim, side.bytes());
  }
  tensor.Number(onnx::kTensorElement, Widened(value.type));
  if (value.has_shape) tensor.Bytes(onnx::kTensorShape, shape.bytes());
  type.Bytes(onnx::kTypeTensor, tensor.bytes());
  whole.Bytes(onnx::kValueName, value.name).Bytes(onnx::kValueType, type.bytes());
  return whole.bytes();
}

class Rewriter {
 public:
  Rewriter(const OnnxOutline& outline, const OnnxReading& reading, const std::string& name)
      : outline_(outline), reading_(reading), name_(name), keep_(outline.steps.size(), false) {
    FindNeeded();
  }

  std::string Model(std::string_view bytes) {
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kProducer && field.IsBytes()) around_.producer = field.bytes;
      if (field.number == onnx::kOpset && field.IsBytes()) ReadOpset(field.bytes);
      if (field.number == onnx::kGraph && field.IsBytes()) FindConstants(field.bytes);
    });
    ProtobufWriter out;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number != onnx::kGraph || !field.IsBytes()) {
        out.Copy(field);
        return;
      }
      out.Bytes(onnx::kGraph, Graph(field.bytes));
    });
    return out.bytes();
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  // Steps stand in the order in which they run, so one way back through them finds all that the output needs.
  void FindNeeded() {
    needed_.insert(reading_.output);
    for (std::size_t i = outline_.steps.size(); i-- > 0;) {
      const OnnxStep& step = outline_.steps[i];
      keep_[i] = std::any_of(step.outputs.begin(), step.outputs.end(), [&](const std::string& output) {
        return !output.empty() && needed_.contains(output);
      });
      if (!keep_[i]) continue;
      if (step.has_graphs)
        Refuse(fmt::format("operator {} has graphs of its own, which are not supported", step.Text()));
      needed_.insert(step.inputs.begin(), step.inputs.end());
    }
    if (!needed_.contains(reading_.input))
      Refuse(
          fmt::format("its output '{}' does not depend on its input '{}'", reading_.output, reading_.input));
  }

  // Of the standard's own operators.
  void ReadOpset(std::string_view bytes) {
    std::string_view domain;
    std::int64_t version = 1;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kOpsetDomain && field.IsBytes()) domain = field.bytes;
      if (field.number == onnx::kOpsetVersion) version = static_cast<std::int64_t>(field.value);
    });
    if (domain.empty() || domain == "ai.onnx") around_.opset = version;
  }

  // Constants stand among the weights or come from a step of their own.
  void FindConstants(std::string_view graph) {
    ForEachField(graph, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kInitializer && field.IsBytes())
        around_.constants[TensorName(field.bytes)] = ConstantOf(Tensor(field.bytes), name_);
      if (field.number != onnx::kNode || !field.IsBytes()) return;
      std::string output;
      std::string_view attribute, op;
      ForEachField(field.bytes, name_, [&](const ProtobufField& part) {
        if (part.number == onnx::kNodeOutput && part.IsBytes()) output = part.bytes;
        if (part.number == onnx::kNodeAttribute && part.IsBytes()) attribute = part.bytes;
        if (part.number == onnx::kNodeOp && part.IsBytes()) op = part.bytes;
      });
      if (op != "Constant") return;
      ForEachField(attribute, name_, [&](const ProtobufField& part) {
        if (part.number == onnx::kAttributeTensor && part.IsBytes())
          around_.constants[output] = ConstantOf(Tensor(part.bytes), name_);
      });
    });
  }

  std::string Graph(std::string_view bytes) {
    ProtobufWriter out;
    OnnxShapes shapes(around_, reading_.input, InputSides(), name_);
    std::size_t step = 0;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      switch (field.number) {
        case onnx::kNode:
          if (!keep_.at(step++)) break;
          shapes.Add(NodeOf(field.bytes, name_));
          for (const std::string& node : Mended(Node(field.bytes), around_, name_))
            out.Bytes(onnx::kNode, node);
          break;
        case onnx::kInitializer:
          if (needed_.contains(TensorName(field.bytes))) out.Bytes(onnx::kInitializer, Tensor(field.bytes));
          break;
        case onnx::kInput:
          Input(ParseOnnxValue(field.bytes, name_), out);
          break;
        case onnx::kOutput:
          Output(ParseOnnxValue(field.bytes, name_), out);
          break;
        case onnx::kValueInfo:
          Between(ParseOnnxValue(field.bytes, name_), out);
          break;
        default:
          out.Copy(field);
      }
    });
    return out.bytes();
  }

  OnnxSides InputSides() const {
    if (reading_.channels == ChannelPlace::kFirst) return {1, 3, reading_.height_px, reading_.width_px};
    return {1, reading_.height_px, reading_.width_px, 3};
  }

  void Input(OnnxValue value, ProtobufWriter& out) const {
    if (value.name != reading_.input) {
      if (needed_.contains(value.name)) out.Bytes(onnx::kInput, ValueBytes(value));  // weights, listed
      return;
    }
    const OnnxSides sides = InputSides();
    for (std::size_t i = 0; i < value.dims.size(); ++i) value.dims[i].size = sides[i];
    out.Bytes(onnx::kInput, ValueBytes(value));
  }

  // A step with several outputs gives OpenCV's caller the first of them; one behind it gives the asked one.
  void Output(OnnxValue value, ProtobufWriter& out) const {
    if (value.name != reading_.output) return;
    bool alone = true;
    for (const OnnxStep& step : outline_.steps)
      if (step.outputs.size() > 1 &&
          std::find(step.outputs.begin(), step.outputs.end(), value.name) != step.outputs.end())
        alone = false;
    if (!alone) {
      ProtobufWriter step;
      step.Bytes(onnx::kNodeInput, value.name);
      value.name += "_of_several";
      step.Bytes(onnx::kNodeOutput, value.name).Bytes(onnx::kNodeName, value.name);
      step.Bytes(onnx::kNodeOp, "Identity");
      out.Bytes(onnx::kNode, step.bytes());
    }
    out.Bytes(onnx::kOutput, ValueBytes(value));
  }

  // Shapes of values between, which are no longer right where the input's was open.
  void Between(const OnnxValue& value, ProtobufWriter& out) const {
    if (!reading_.pinned && value.type != 0 && needed_.contains(value.name))
      out.Bytes(onnx::kValueInfo, ValueBytes(value));
  }

  // OpenCV wants every step to have a name of its own; the standard does not.
  std::string Node(std::string_view bytes) {
    std::string_view op, node;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.IsBytes() && field.number == onnx::kNodeOp) op = field.bytes;
      if (field.IsBytes() && field.number == onnx::kNodeName) node = field.bytes;
    });
    const bool taken = !node.empty() && !node_names_.insert(std::string(node)).second;
    ProtobufWriter out;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.IsBytes() && field.number == onnx::kNodeAttribute)
        out.Bytes(field.number, Attribute(field.bytes, op == "Cast"));
      else if (field.number != onnx::kNodeName || !taken)
        out.Copy(field);
    });
    return out.bytes();
  }

  std::string Attribute(std::string_view bytes, bool of_cast) const {
    ProtobufWriter out;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      const bool number = field.wire == ProtobufField::Wire::kNumber;
      if (field.IsBytes() && field.number == onnx::kAttributeTensor)
        out.Bytes(field.number, Tensor(field.bytes));
      else if (of_cast && number && field.number == onnx::kAttributeInt)
        out.Number(field.number, Widened(field.value));
      else
        out.Copy(field);
    });
    return out.bytes();
  }

  std::string TensorName(std::string_view bytes) const {
    std::string found;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.IsBytes() && field.number == onnx::kTensorName) found = field.bytes;
    });
    return found;
  }

  // Half precision stands in raw bytes, two each, or one by one among the 32-bit integers.
  std::string Tensor(std::string_view bytes) const {
    std::uint64_t type = 0;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kType) type = field.value;
    });
    if (type != onnx::kFloat16) return std::string(bytes);
    ProtobufWriter out;
    std::string raw;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kRaw && field.IsBytes()) {
        for (std::size_t i = 0; i + 1 < field.bytes.size(); i += 2)
          AppendFloat(static_cast<unsigned char>(field.bytes[i]) |
                          std::uint64_t{static_cast<unsigned char>(field.bytes[i + 1])} << 8,
                      raw);
      } else if (field.number == onnx::kInt32s) {
        if (field.wire == ProtobufField::Wire::kNumber) AppendFloat(field.value, raw);
        for (std::string_view packed = field.IsBytes() ? field.bytes : ""; !packed.empty();)
          AppendFloat(TakeVarint(packed, name_), raw);
      } else if (field.number != onnx::kType) {
        out.Copy(field);
      }
    });
    return out.Number(onnx::kType, onnx::kFloat).Bytes(onnx::kRaw, raw).bytes();
  }

  const OnnxOutline& outline_;
  const OnnxReading& reading_;
  const std::string& name_;
  std::vector<bool> keep_;        // of the steps
  std::set<std::string> needed_;  // values
  std::set<std::string> node_names_;
  OnnxSurroundings around_;
};

}  // namespace

std::string ForOpenCv(std::string_view bytes, const OnnxOutline& outline, const OnnxReading& reading,
                      const std::string& name) {
  return Rewriter(outline, reading, name).Model(bytes);
}

}  // namespace ed3r::perception
