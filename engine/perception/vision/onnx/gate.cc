#include "engine/perception/vision/onnx/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/protobuf.h"
#include "engine/perception/vision/onnx/fields.h"

namespace ed3r::perception {
namespace {

constexpr std::int64_t kMaxDimension = 1 << 24;

class Gate {
 public:
  explicit Gate(const std::string& name) : name_(name) {}

  void CheckModel(std::string_view bytes) const {
    bool has_graph = false;
    ForEach(bytes, [&](const ProtobufField& field) {
      if (field.number != onnx::kGraph || !field.IsBytes()) return;
      if (has_graph) Refuse("is no ONNX model: it has several graphs");
      has_graph = true;
      CheckGraph(field.bytes, 0);
    });
    if (!has_graph) Refuse("is no ONNX model: it has no graph");
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  template <class Visit>
  void ForEach(std::string_view bytes, Visit visit) const {
    ForEachField(bytes, name_, visit);
  }

  void CheckGraph(std::string_view bytes, int depth) const {
    if (depth > onnx::kMaxDepth) Refuse("has graphs within graphs without end");
    ForEach(bytes, [&](const ProtobufField& field) {
      if (!field.IsBytes()) return;
      if (field.number == onnx::kSparseInitializer) Refuse("has sparse weights; allowed: dense ones");
      if (field.number == onnx::kNode) CheckNode(field.bytes, depth);
      if (field.number == onnx::kInitializer) CheckTensor(field.bytes);
      if (field.number == onnx::kInput || field.number == onnx::kOutput || field.number == onnx::kValueInfo)
        CheckValueInfo(field.bytes);
    });
  }

  void CheckNode(std::string_view bytes, int depth) const {
    ForEach(bytes, [&](const ProtobufField& field) {
      if (field.IsBytes() && field.number == onnx::kNodeAttribute) CheckAttribute(field.bytes, depth);
    });
  }

  void CheckAttribute(std::string_view bytes, int depth) const {
    std::string_view name;
    std::vector<std::int64_t> numbers;
    ForEach(bytes, [&](const ProtobufField& field) {
      if (field.number == onnx::kAttributeInt || field.number == onnx::kAttributeInts)
        onnx::Append(field, name_, numbers);
      if (!field.IsBytes()) return;
      if (field.number == onnx::kAttributeName) name = field.bytes;
      if (field.number == onnx::kAttributeTensor || field.number == onnx::kAttributeTensors)
        CheckTensor(field.bytes);
      if (field.number == onnx::kAttributeGraph || field.number == onnx::kAttributeGraphs)
        CheckGraph(field.bytes, depth + 1);
    });
    CheckSizes(name, numbers);
  }

  // Attributes by which OpenCV divides or allocates.
  void CheckSizes(std::string_view attribute, const std::vector<std::int64_t>& numbers) const {
    constexpr std::array<std::string_view, 7> kPositive = {"kernel_shape", "strides", "dilations",   "group",
                                                           "blocksize",    "size",    "output_shape"};
    constexpr std::array<std::string_view, 3> kAny = {"pads", "output_padding", "axis"};
    constexpr std::int64_t kMax = 1 << 16;
    const bool positive = std::find(kPositive.begin(), kPositive.end(), attribute) != kPositive.end();
    if (!positive && std::find(kAny.begin(), kAny.end(), attribute) == kAny.end()) return;
    for (const std::int64_t number : numbers)
      if (number > kMax || number < (positive ? 1 : -kMax))
        Refuse(fmt::format("has {} = {}; allowed: {} .. {}", attribute, number, positive ? 1 : -kMax, kMax));
  }

  std::int64_t Elements(const std::vector<std::int64_t>& dims, std::string_view what) const {
    std::int64_t elements = 1;
    for (const std::int64_t dim : dims) {
      if (dim < 0 || dim > kMaxDimension || (dim > 0 && elements > onnx::kMostElements / dim))
        Refuse(fmt::format(
            "has {} with the shape [{}]; allowed: sides of 0 .. {}, at most {} elements", what,
            fmt::join(dims.begin(), dims.begin() + std::min<std::ptrdiff_t>(8, std::ssize(dims)), ", "),
            kMaxDimension, onnx::kMostElements));
      elements *= dim;
    }
    return elements;
  }

  // Values that a field of a tensor lists, one by one or packed.
  static std::size_t Listed(const ProtobufField& field) {
    using Wire = ProtobufField::Wire;
    switch (field.number) {
      case onnx::kFloats:
        return field.IsBytes() || field.wire == Wire::kFixed32 ? field.bytes.size() / 4 : 0;
      case onnx::kDoubles:
        return field.IsBytes() || field.wire == Wire::kFixed64 ? field.bytes.size() / 8 : 0;
      default:
        if (!field.IsBytes()) return field.wire == Wire::kNumber ? 1 : 0;
        return static_cast<std::size_t>(std::count_if(field.bytes.begin(), field.bytes.end(), [](char c) {
          return static_cast<unsigned char>(c) < 0x80;  // the last byte of a number
        }));
    }
  }

  void CheckTensor(std::string_view bytes) const {
    std::vector<std::int64_t> dims;
    std::string_view name;
    std::uint64_t type = 0;
    std::size_t raw = 0;
    std::map<std::uint32_t, std::size_t> lists;  // by the field
    bool has_raw = false;
    ForEach(bytes, [&](const ProtobufField& field) {
      if (field.number == onnx::kDims) onnx::Append(field, name_, dims);
      if (field.number == onnx::kTensorName && field.IsBytes()) name = field.bytes;
      if (field.number == onnx::kType) type = field.value;
      if (field.number == onnx::kRaw && field.IsBytes()) raw = field.bytes.size(), has_raw = true;
      lists[field.number] += Listed(field);
      if (field.number == onnx::kLocation && field.value == onnx::kLiesOutside)
        Refuse("keeps weights in another file (external data)");
    });
    const std::int64_t elements = Elements(dims, fmt::format("a tensor '{}'", name));
    // Bytes of an element by its type: float, uint8, int8, uint16, int16, int32, int64, -, bool, float16, double, ...
    constexpr std::array<std::size_t, 14> kBytes = {0, 4, 1, 1, 2, 2, 4, 8, 0, 1, 2, 8, 4, 8};
    const std::size_t size = type < kBytes.size() ? kBytes[type] : 0;
    if (size == 0)
      Refuse(fmt::format("has a tensor '{}' of {}; allowed: float, double, float16, integers", name,
                         onnx::TypeName(type)));
    // OpenCV reads the list of the type's own, and before raw bytes.
    constexpr std::array<std::uint32_t, 14> kList = {0,
                                                     onnx::kFloats,
                                                     onnx::kInt32s,
                                                     onnx::kInt32s,
                                                     onnx::kInt32s,
                                                     onnx::kInt32s,
                                                     onnx::kInt32s,
                                                     onnx::kInt64s,
                                                     0,
                                                     onnx::kInt32s,
                                                     onnx::kInt32s,
                                                     onnx::kDoubles,
                                                     onnx::kUint64s,
                                                     onnx::kUint64s};
    const std::size_t listed = lists[kList[type]];
    const bool fits = has_raw ? raw == static_cast<std::size_t>(elements) * size && listed == 0
                              : listed >= static_cast<std::size_t>(elements);
    if (!fits)
      Refuse(fmt::format("has a tensor '{}' of {} elements with {} {}", name, elements,
                         has_raw ? raw : listed, has_raw ? "bytes of values" : "values"));
  }

  // An input, an output or a value between: its shape, where it is told in numbers.
  void CheckValueInfo(std::string_view bytes) const {
    std::string_view name;
    std::vector<std::int64_t> dims;
    ForEach(bytes, [&](const ProtobufField& field) {
      if (field.IsBytes() && field.number == onnx::kValueName) name = field.bytes;
      if (field.IsBytes() && field.number == onnx::kValueType)
        ForEachIn(field.bytes, onnx::kTypeTensor, [&](std::string_view tensor) {
          ForEachIn(tensor, onnx::kTensorShape, [&](std::string_view shape) {
            ForEachIn(shape, onnx::kShapeDim, [&](std::string_view dim) {
              ForEach(dim, [&](const ProtobufField& value) {
                if (value.number == onnx::kDimValue) onnx::Append(value, name_, dims);
              });
            });
          });
        });
    });
    std::erase(dims, onnx::kOpenSide);
    Elements(dims, fmt::format("a value '{}'", name));
  }

  template <class Visit>
  void ForEachIn(std::string_view bytes, std::uint32_t number, Visit visit) const {
    ForEach(bytes, [&](const ProtobufField& field) {
      if (field.IsBytes() && field.number == number) visit(field.bytes);
    });
  }

  const std::string& name_;
};

}  // namespace

void CheckOnnx(std::string_view bytes, const std::string& name) { Gate(name).CheckModel(bytes); }

}  // namespace ed3r::perception
