#include "engine/world/text_place.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>

#include "engine/core/check.h"

namespace ed3r {

void FailAt(const TextPlace& place, const std::string& problem) {
  throw UserError(fmt::format("{}:{}:{}: {}", place.file, place.line, place.column, problem));
}

std::string ReadTextFile(const std::string& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  std::array<char, 1 << 16> block;
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  // A folder opens, but its first read fails.
  if (!stream.is_open() || stream.bad())
    throw UserError(
        fmt::format("{}: cannot be read ({})", file, errno != 0 ? std::strerror(errno) : "read error"));
  return text;
}

}  // namespace ed3r
