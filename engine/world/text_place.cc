#include "engine/world/text_place.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "engine/core/check.h"

namespace ed3r {

void FailAt(const TextPlace& place, const std::string& problem) {
  throw UserError(fmt::format("{}:{}:{}: {}", place.file, place.line, place.column, problem));
}

std::string ReadTextFile(const std::string& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  // A folder opens, but its first read fails; that leaves the stream bad and the text empty.
  if (!stream.is_open() || stream.bad())
    throw UserError(
        fmt::format("{}: cannot be read ({})", file, errno != 0 ? std::strerror(errno) : "read error"));
  return text;
}

}  // namespace ed3r
