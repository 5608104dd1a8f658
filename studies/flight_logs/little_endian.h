// Numbers in the bytes of a file, little-endian, every access checked against the end.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "engine/core/check.h"

namespace ed3r {

static_assert(std::endian::native == std::endian::little);

// The caller has compared the place with the file's size; a mistake there ends the program, not the memory.
template <class Number>
Number LoadLittleEndian(std::string_view bytes, std::size_t at) {
  ED3R_CHECK(at <= bytes.size() && sizeof(Number) <= bytes.size() - at, "read past the end of a log");
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof(Number));
  return number;
}

}  // namespace ed3r
