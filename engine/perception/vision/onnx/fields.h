// Field numbers and element types of onnx.proto, as far as detectors need them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/files/protobuf.h"

namespace ed3r::perception::onnx {

enum ModelField : std::uint32_t {
  kProducer = 2,
  kGraph = 7,
  kOpset = 8,
  kOpsetDomain = 1,
  kOpsetVersion = 2
};
enum GraphField : std::uint32_t {
  kNode = 1,
  kInitializer = 5,
  kInput = 11,
  kOutput = 12,
  kValueInfo = 13,
  kSparseInitializer = 15
};
enum NodeField : std::uint32_t {
  kNodeInput = 1,
  kNodeOutput = 2,
  kNodeName = 3,
  kNodeOp = 4,
  kNodeAttribute = 5,
  kNodeDomain = 7
};
enum AttributeField : std::uint32_t {
  kAttributeName = 1,
  kAttributeFloat = 2,
  kAttributeInt = 3,
  kAttributeText = 4,
  kAttributeTensor = 5,
  kAttributeGraph = 6,
  kAttributeFloats = 7,
  kAttributeInts = 8,
  kAttributeTexts = 9,
  kAttributeTensors = 10,
  kAttributeGraphs = 11,
  kAttributeType = 20
};
enum TensorField : std::uint32_t {
  kDims = 1,
  kType = 2,
  kFloats = 4,
  kInt32s = 5,
  kInt64s = 7,
  kTensorName = 8,
  kRaw = 9,
  kDoubles = 10,
  kUint64s = 11,
  kExternal = 13,
  kLocation = 14
};
enum PairField : std::uint32_t { kPairKey = 1, kPairValue = 2 };
enum ValueField : std::uint32_t {
  kValueName = 1,
  kValueType = 2,
  kTypeTensor = 1,
  kTensorElement = 1,
  kTensorShape = 2,
  kShapeDim = 1,
  kDimValue = 1,
  kDimName = 2
};

inline constexpr std::uint64_t kTypeOfFloat = 1, kTypeOfInt = 2, kTypeOfText = 3, kTypeOfTensor = 4,
                               kTypeOfInts = 7;  // of attributes
inline constexpr std::uint64_t kFloat = 1, kInt32 = 6, kInt64 = 7, kFloat16 = 10, kDouble = 11;
inline constexpr std::uint64_t kLiesOutside = 1;  // of kLocation
inline constexpr std::int64_t kOpenSide = -1;     // what some exporters write for a side that is left open

inline constexpr std::int64_t kMostElements = 1 << 28;  // of a tensor: a gigabyte of floats
inline constexpr int kMaxDepth = 16;                    // of graphs within nodes

// Appends the whole numbers of a list's field, which stand one by one or packed. `name` begins messages. Throws UserError for
// other bytes, and for more than a million numbers.
void Append(const ProtobufField& field, const std::string& name, std::vector<std::int64_t>& numbers);

std::string TensorName(std::string_view tensor, const std::string& name);

// "float16"; "of the number 99" for what no version of the format has.
std::string TypeName(std::uint64_t type);

}  // namespace ed3r::perception::onnx
