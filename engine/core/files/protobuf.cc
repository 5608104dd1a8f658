#include "engine/core/files/protobuf.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "engine/core/check.h"

namespace ed3r {
namespace {

std::string_view Take(std::string_view& bytes, std::uint64_t size, const std::string& name) {
  if (size > bytes.size()) throw UserError(fmt::format("{}: is no ONNX model, or is cut short", name));
  const std::string_view taken = bytes.substr(0, size);
  bytes.remove_prefix(size);
  return taken;
}

}  // namespace

std::uint64_t TakeVarint(std::string_view& bytes, const std::string& name) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const auto byte = static_cast<unsigned char>(Take(bytes, 1, name).front());
    value |= static_cast<std::uint64_t>(byte & 0x7fU) << shift;
    if (byte < 0x80) return value;
  }
  throw UserError(fmt::format("{}: is no ONNX model: a number does not end", name));
}

void ForEachField(std::string_view message, const std::string& name,
                  const std::function<void(const ProtobufField&)>& visit) {
  using Wire = ProtobufField::Wire;
  while (!message.empty()) {
    const std::string_view begin = message;
    const std::uint64_t key = TakeVarint(message, name);
    ProtobufField field;
    field.number = static_cast<std::uint32_t>(std::min<std::uint64_t>(key >> 3, UINT32_MAX));
    if (field.number == 0)
      throw UserError(fmt::format(
          "{}: is no ONNX model: a field of number 0, such as zeros make that a disk left", name));
    switch (key & 7) {
      case 0:
        field.value = TakeVarint(message, name);
        break;
      case 1:
        field.wire = Wire::kFixed64;
        field.bytes = Take(message, 8, name);
        break;
      case 2:
        field.wire = Wire::kBytes;
        field.bytes = Take(message, TakeVarint(message, name), name);
        break;
      case 5:
        field.wire = Wire::kFixed32;
        field.bytes = Take(message, 4, name);
        break;
      default:
        throw UserError(fmt::format("{}: is no ONNX model: a field of unknown kind", name));
    }
    field.whole = begin.substr(0, begin.size() - message.size());
    visit(field);
  }
}

void ProtobufWriter::Varint(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_ += static_cast<char>((value & 0x7f) | 0x80);
  bytes_ += static_cast<char>(value);
}

ProtobufWriter& ProtobufWriter::Number(std::uint32_t field, std::uint64_t value) {
  Varint(std::uint64_t{field} << 3);
  Varint(value);
  return *this;
}

ProtobufWriter& ProtobufWriter::Float(std::uint32_t field, float value) {
  Varint(std::uint64_t{field} << 3 | 5);
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int i = 0; i < 4; ++i) bytes_ += static_cast<char>(bits >> (8 * i));
  return *this;
}

ProtobufWriter& ProtobufWriter::Bytes(std::uint32_t field, std::string_view value) {
  Varint(std::uint64_t{field} << 3 | 2);
  Varint(value.size());
  bytes_ += value;
  return *this;
}

ProtobufWriter& ProtobufWriter::Copy(const ProtobufField& field) {
  bytes_ += field.whole;
  return *this;
}

}  // namespace ed3r
