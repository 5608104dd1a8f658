#include "engine/perception/vision/onnx/rewrite.h"

#include <fmt/format.h>
#include <opencv2/core/cvdef.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <map>
#include <optional>
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
      if (field.number == onnx::kOpset && field.IsBytes()) ReadOpset(field.bytes);
      if (field.number == onnx::kGraph && field.IsBytes()) FindConstants(field.bytes);
    });
    ProtobufWriter out;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kGraph && field.IsBytes())
        out.Bytes(onnx::kGraph, Graph(field.bytes));
      else if (field.number != onnx::kProducer)
        out.Copy(field);
    });
    return out.Bytes(onnx::kProducer, counts_padding_.value_or(false) ? "pytorch" : "").bytes();
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
        AddConstant(onnx::TensorName(field.bytes, name_), field.bytes);
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
        if (part.number == onnx::kAttributeTensor && part.IsBytes()) AddConstant(output, part.bytes);
      });
    });
  }

  void AddConstant(const std::string& value, std::string_view tensor) {
    around_.constants[value] = ConstantOf(Tensor(tensor), name_);
    tensors_[value] = tensor;
  }

  std::string Graph(std::string_view bytes) {
    ProtobufWriter out;
    OnnxShapes shapes(around_, reading_.input, InputSides(), name_);
    std::size_t step = 0;
    ForEachField(bytes, name_, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      switch (field.number) {
        case onnx::kNode:
          if (keep_.at(step++)) Step(field.bytes, shapes, out);
          break;
        case onnx::kInitializer:
          if (needed_.contains(onnx::TensorName(field.bytes, name_)))
            out.Bytes(onnx::kInitializer, Tensor(field.bytes));
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

  void Step(std::string_view bytes, OnnxShapes& shapes, ProtobufWriter& out) {
    OnnxNode node = NodeOf(bytes, name_);
    for (std::string& input : node.inputs) input = Through(input);
    const bool own = node.domain.empty() || node.domain == "ai.onnx";
    if (own && node.op == "Identity" && node.inputs.size() == 1 && node.outputs.size() == 1 &&
        around_.constants.contains(node.inputs[0])) {
      same_[node.outputs[0]] = node.inputs[0];
      return;
    }
    shapes.Add(node);
    if (node.op == "AveragePool") FollowPadding(node);
    if (node.op == "Div" && around_.constants.contains(node.inputs[1])) {
      Quotient(bytes, node, out);
      return;
    }
    const std::size_t rank = node.inputs.empty() ? 0 : shapes.Of(node.inputs[0]).size();
    for (const std::string& mended : Mended(Node(bytes), rank, around_, name_))
      out.Bytes(onnx::kNode, mended);
  }

  // OpenCV turns the constant that it divides by into its reciprocal, for every other step that takes it, too.
  void Quotient(std::string_view bytes, const OnnxNode& node, ProtobufWriter& out) {
    const std::string own = "divisor of " + node.outputs.at(0);
    ProtobufWriter value, constant, quotient;
    value.Bytes(onnx::kAttributeName, "value");
    value.Bytes(onnx::kAttributeTensor, Tensor(tensors_.at(node.inputs[1])));
    value.Number(onnx::kAttributeType, onnx::kTypeOfTensor);
    constant.Bytes(onnx::kNodeOutput, own).Bytes(onnx::kNodeName, own).Bytes(onnx::kNodeOp, "Constant");
    out.Bytes(onnx::kNode, constant.Bytes(onnx::kNodeAttribute, value.bytes()).bytes());
    int input = 0;
    ForEachField(Node(bytes), name_, [&](const ProtobufField& field) {
      if (field.number == onnx::kNodeInput && input++ == 1)
        quotient.Bytes(onnx::kNodeInput, own);
      else
        quotient.Copy(field);
    });
    out.Bytes(onnx::kNode, quotient.bytes());
  }

  // The constant that an Identity gave another name, which OpenCV does not take for one.
  std::string Through(const std::string& value) const {
    const auto found = same_.find(value);
    return found == same_.end() ? value : found->second;
  }

  // OpenCV lets padding count in all averages of a model from pytorch, and in none of any other.
  void FollowPadding(const OnnxNode& node) {
    const std::vector<std::int64_t> pads = node.Numbers("pads");
    const bool padded = node.Word("auto_pad", "") == "SAME_UPPER" ||
                        std::any_of(pads.begin(), pads.end(), [](std::int64_t pad) { return pad != 0; });
    if (!padded) return;
    const bool counts = node.Number("count_include_pad", 0) != 0;
    if (counts_padding_.value_or(counts) != counts)
      Refuse(fmt::format(
          "operator {} has count_include_pad = {}, and one before it {}; allowed: alike in all with "
          "pads, or a Pad before an AveragePool without pads",
          node.Text(), counts ? 1 : 0, counts ? 0 : 1));
    counts_padding_ = counts;
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
      else if (field.IsBytes() && field.number == onnx::kNodeInput)
        out.Bytes(field.number, Through(std::string(field.bytes)));
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
  std::map<std::string, std::string_view> tensors_;  // of the constants, as the file has them
  std::map<std::string, std::string> same_;          // constants by their other names
  std::optional<bool> counts_padding_;               // in averages, if any has padding
};

}  // namespace

std::string ForOpenCv(std::string_view bytes, const OnnxOutline& outline, const OnnxReading& reading,
                      const std::string& name) {
  return Rewriter(outline, reading, name).Model(bytes);
}

}  // namespace ed3r::perception
