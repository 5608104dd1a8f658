#include "engine/core/message.h"

#include <fmt/format.h>

namespace ed3r {
namespace {

bool Continues(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }  // inside a UTF-8 character

}  // namespace

std::string OneLine(std::string_view text) {
  constexpr std::string_view kLeftOut = " ... ";
  constexpr std::size_t kTail = 160, kHead = kMaxMessageBytes - kTail - kLeftOut.size();
  std::string line;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      line += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    else
      line += c;
  }
  if (line.size() <= kMaxMessageBytes) return line;
  std::size_t head = kHead, tail = line.size() - kTail;
  while (head > kHead - 4 && Continues(line[head])) --head;
  while (tail < line.size() - kTail + 4 && Continues(line[tail])) ++tail;
  return line.substr(0, head).append(kLeftOut).append(line, tail);
}

}  // namespace ed3r
