#include "engine/perception/vision/onnx/fields.h"

#include <fmt/format.h>

#include <array>

#include "engine/core/check.h"

namespace ed3r::perception {

void onnx::Append(const ProtobufField& field, const std::string& name, std::vector<std::int64_t>& numbers) {
  constexpr std::size_t kMost = 1 << 20;
  const bool one = field.wire == ProtobufField::Wire::kNumber;
  if (!one && !field.IsBytes())
    throw UserError(name + ": has a list of whole numbers that are none; allowed: int64");
  if (numbers.size() + field.bytes.size() > kMost)
    throw UserError(name + ": has a list of more than a million numbers");
  if (one) numbers.push_back(static_cast<std::int64_t>(field.value));
  for (std::string_view packed = one ? "" : field.bytes; !packed.empty();)
    numbers.push_back(static_cast<std::int64_t>(TakeVarint(packed, name)));
}

std::string onnx::TensorName(std::string_view tensor, const std::string& name) {
  std::string found;
  ForEachField(tensor, name, [&](const ProtobufField& field) {
    if (field.IsBytes() && field.number == kTensorName) found = field.bytes;
  });
  return found;
}

std::string onnx::TypeName(std::uint64_t type) {
  constexpr std::array<const char*, 17> kNames = {
      "none",  "float",   "uint8",  "int8",   "uint16", "int16",     "int32",      "int64",   "text",
      "truth", "float16", "double", "uint32", "uint64", "complex64", "complex128", "bfloat16"};
  return type < kNames.size() ? kNames[type] : fmt::format("number {}", type);
}

}  // namespace ed3r::perception
