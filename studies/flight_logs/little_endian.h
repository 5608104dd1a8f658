// Numbers in the bytes of a file, little-endian, every access checked against the end.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "engine/core/check.h"

namespace ed3r::flight_logs {

static_assert(std::endian::native == std::endian::little);

// The caller has compared the place with the file's size; a mistake there ends the program, not the memory.
template <class Number>
Number LoadLittleEndian(std::string_view bytes, std::size_t at) {
  ED3R_CHECK(at <= bytes.size() && sizeof(Number) <= bytes.size() - at, "read past the end of a log");
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof(Number));
  return number;
}

// A number by the code that Python's struct has for its type: b B h H i I q Q f d. Nothing for another code, and where the
// bytes end before it does.
inline std::optional<double> LoadNumber(char code, std::string_view bytes, std::size_t at) {
  const auto load = [&]<class Number>(Number) -> std::optional<double> {
    if (at > bytes.size() || sizeof(Number) > bytes.size() - at) return std::nullopt;
    return static_cast<double>(LoadLittleEndian<Number>(bytes, at));
  };
  switch (code) {
    case 'b':
      return load(std::int8_t{});
    case 'B':
      return load(std::uint8_t{});
    case 'h':
      return load(std::int16_t{});
    case 'H':
      return load(std::uint16_t{});
    case 'i':
      return load(std::int32_t{});
    case 'I':
      return load(std::uint32_t{});
    case 'q':
      return load(std::int64_t{});
    case 'Q':
      return load(std::uint64_t{});
    case 'f':
      return load(float{});
    case 'd':
      return load(double{});
    default:
      return std::nullopt;
  }
}

}  // namespace ed3r::flight_logs
