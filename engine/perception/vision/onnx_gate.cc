#include "engine/perception/vision/onnx_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/core/check.h"

namespace ed3r {
namespace {

constexpr std::int64_t kMaxDimension = 1 << 24;
constexpr std::int64_t kMaxElements = 1 << 28;  // of a tensor: a gigabyte of floats
constexpr int kMaxDepth = 16;                   // of graphs within nodes

// Field numbers of onnx.proto.
enum Model { kModelGraph = 7 };
enum Graph {
  kGraphNode = 1,
  kGraphInitializer = 5,
  kGraphInput = 11,
  kGraphOutput = 12,
  kGraphValueInfo = 13
};
enum Node { kNodeAttribute = 5 };
enum Attribute {
  kAttributeName = 1,
  kAttributeInt = 3,
  kAttributeTensor = 5,
  kAttributeGraph = 6,
  kAttributeInts = 8,
  kAttributeTensors = 10,
  kAttributeGraphs = 11
};
enum Tensor {
  kTensorDims = 1,
  kTensorType = 2,
  kTensorFloats = 4,
  kTensorInt32s = 5,
  kTensorInt64s = 7,
  kTensorName = 8,
  kTensorRaw = 9,
  kTensorDoubles = 10,
  kTensorUint64s = 11,
  kTensorLocation = 14
};
enum ValueInfo {
  kValueName = 1,
  kValueType = 2,
  kTypeTensor = 1,
  kTensorShape = 2,
  kShapeDim = 1,
  kDimValue = 1
};

enum class Wire { kNumber, kFixed64, kBytes, kFixed32 };

struct Field {
  std::uint32_t number = 0;
  Wire wire = Wire::kNumber;
  std::uint64_t value = 0;  // of a number
  std::string_view bytes;   // of a message, a text or packed numbers

  bool IsBytes() const { return wire == Wire::kBytes; }
};

class Gate {
 public:
  explicit Gate(const std::string& name) : name_(name) {}

  void CheckModel(std::string_view bytes) const {
    bool has_graph = false;
    ForEachField(bytes, [&](const Field& field) {
      if (field.number != kModelGraph || !field.IsBytes()) return;
      has_graph = true;
      CheckGraph(field.bytes, 0);
    });
    if (!has_graph) Refuse("is no ONNX model: it has no graph");
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  std::uint64_t Varint(std::string_view& bytes) const {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      if (bytes.empty()) Refuse("is no ONNX model, or is cut short");
      const auto byte = static_cast<unsigned char>(bytes.front());
      bytes.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    Refuse("is no ONNX model: a number does not end");
  }

  std::string_view Take(std::string_view& bytes, std::uint64_t size) const {
    if (size > bytes.size()) Refuse("is no ONNX model, or is cut short");
    const std::string_view taken = bytes.substr(0, size);
    bytes.remove_prefix(size);
    return taken;
  }

  template <class Visit>
  void ForEachField(std::string_view bytes, Visit visit) const {
    while (!bytes.empty()) {
      const std::uint64_t key = Varint(bytes);
      Field field;
      field.number = static_cast<std::uint32_t>(std::min<std::uint64_t>(key >> 3, UINT32_MAX));
      switch (key & 7) {
        case 0:
          field.value = Varint(bytes);
          break;
        case 1:
          field.wire = Wire::kFixed64;
          field.bytes = Take(bytes, 8);
          break;
        case 2:
          field.wire = Wire::kBytes;
          field.bytes = Take(bytes, Varint(bytes));
          break;
        case 5:
          field.wire = Wire::kFixed32;
          field.bytes = Take(bytes, 4);
          break;
        default:
          Refuse("is no ONNX model: a field of unknown kind");
      }
      visit(field);
    }
  }

  // Numbers stand one by one or packed.
  void Append(const Field& field, std::vector<std::int64_t>& numbers) const {
    constexpr std::size_t kMost = 1 << 20;
    if (numbers.size() + field.bytes.size() > kMost) Refuse("has a list of more than a million numbers");
    if (field.wire == Wire::kNumber) {
      numbers.push_back(static_cast<std::int64_t>(field.value));
      return;
    }
    for (std::string_view packed = field.IsBytes() ? field.bytes : ""; !packed.empty();)
      numbers.push_back(static_cast<std::int64_t>(Varint(packed)));
  }

  void CheckGraph(std::string_view bytes, int depth) const {
    if (depth > kMaxDepth) Refuse("has graphs within graphs without end");
    ForEachField(bytes, [&](const Field& field) {
      if (!field.IsBytes()) return;
      if (field.number == kGraphNode) CheckNode(field.bytes, depth);
      if (field.number == kGraphInitializer) CheckTensor(field.bytes);
      if (field.number == kGraphInput || field.number == kGraphOutput || field.number == kGraphValueInfo)
        CheckValueInfo(field.bytes);
    });
  }

  void CheckNode(std::string_view bytes, int depth) const {
    ForEachField(bytes, [&](const Field& field) {
      if (field.IsBytes() && field.number == kNodeAttribute) CheckAttribute(field.bytes, depth);
    });
  }

  void CheckAttribute(std::string_view bytes, int depth) const {
    std::string_view name;
    std::vector<std::int64_t> numbers;
    ForEachField(bytes, [&](const Field& field) {
      if (field.number == kAttributeInt || field.number == kAttributeInts) Append(field, numbers);
      if (!field.IsBytes()) return;
      if (field.number == kAttributeName) name = field.bytes;
      if (field.number == kAttributeTensor || field.number == kAttributeTensors) CheckTensor(field.bytes);
      if (field.number == kAttributeGraph || field.number == kAttributeGraphs)
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
      if (dim < 0 || dim > kMaxDimension || (dim > 0 && elements > kMaxElements / dim))
        Refuse(fmt::format(
            "has {} with the shape [{}]; allowed: sides of 0 .. {}, at most {} elements", what,
            fmt::join(dims.begin(), dims.begin() + std::min<std::ptrdiff_t>(8, std::ssize(dims)), ", "),
            kMaxDimension, kMaxElements));
      elements *= dim;
    }
    return elements;
  }

  // Values that a field of a tensor lists, one by one or packed.
  static std::size_t Listed(const Field& field) {
    switch (field.number) {
      case kTensorFloats:
        return field.bytes.size() / 4;
      case kTensorDoubles:
        return field.bytes.size() / 8;
      case kTensorInt32s:
      case kTensorInt64s:
      case kTensorUint64s:
        if (field.wire == Wire::kNumber) return 1;
        return static_cast<std::size_t>(std::count_if(field.bytes.begin(), field.bytes.end(), [](char c) {
          return static_cast<unsigned char>(c) < 0x80;  // the last byte of a number
        }));
      default:
        return 0;
    }
  }

  void CheckTensor(std::string_view bytes) const {
    std::vector<std::int64_t> dims;
    std::string_view name;
    std::uint64_t type = 0;
    std::size_t raw = 0, listed = 0;
    bool has_raw = false;
    ForEachField(bytes, [&](const Field& field) {
      if (field.number == kTensorDims) Append(field, dims);
      if (field.number == kTensorName && field.IsBytes()) name = field.bytes;
      if (field.number == kTensorType) type = field.value;
      if (field.number == kTensorRaw && field.IsBytes()) raw = field.bytes.size(), has_raw = true;
      listed += Listed(field);
      if (field.number == kTensorLocation && field.value == 1)
        Refuse(
            "keeps its weights in another file (external data), which is not supported; save it as one file");
    });
    const std::int64_t elements = Elements(dims, fmt::format("a tensor '{}'", name));
    // Bytes of an element by its type: float, uint8, int8, uint16, int16, int32, int64, -, bool, float16, double, ...
    constexpr std::array<std::size_t, 14> kBytes = {0, 4, 1, 1, 2, 2, 4, 8, 0, 1, 2, 8, 4, 8};
    const std::size_t size = type < kBytes.size() ? kBytes[type] : 0;
    if (size == 0)
      Refuse(fmt::format("has a tensor '{}' of the type {}, which is not supported", name, type));
    const bool fits = has_raw ? raw == static_cast<std::size_t>(elements) * size
                              : listed >= static_cast<std::size_t>(elements);
    if (!fits)
      Refuse(fmt::format("has a tensor '{}' of {} elements with {} {}", name, elements,
                         has_raw ? raw : listed, has_raw ? "bytes of values" : "values"));
  }

  // An input, an output or a value between: its shape, where it is told in numbers.
  void CheckValueInfo(std::string_view bytes) const {
    std::string_view name;
    std::vector<std::int64_t> dims;
    ForEachField(bytes, [&](const Field& field) {
      if (field.IsBytes() && field.number == kValueName) name = field.bytes;
      if (field.IsBytes() && field.number == kValueType)
        ForEachIn(field.bytes, kTypeTensor, [&](std::string_view tensor) {
          ForEachIn(tensor, kTensorShape, [&](std::string_view shape) {
            ForEachIn(shape, kShapeDim, [&](std::string_view dim) {
              ForEachField(dim, [&](const Field& value) {
                if (value.number == kDimValue) Append(value, dims);
              });
            });
          });
        });
    });
    Elements(dims, fmt::format("a value '{}'", name));
  }

  template <class Visit>
  void ForEachIn(std::string_view bytes, std::uint32_t number, Visit visit) const {
    ForEachField(bytes, [&](const Field& field) {
      if (field.IsBytes() && field.number == number) visit(field.bytes);
    });
  }

  const std::string& name_;
};

}  // namespace

void CheckOnnx(std::string_view bytes, const std::string& name) { Gate(name).CheckModel(bytes); }

}  // namespace ed3r
