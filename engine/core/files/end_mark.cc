#include "engine/core/files/end_mark.h"

#include <algorithm>

namespace ed3r {
namespace {

// Editors may end lines otherwise, or leave spaces at their end.
bool HasLine(std::string_view text, std::string_view wanted) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (line == wanted) return true;
    begin = end + 1;
  }
  return false;
}

}  // namespace

bool IsCutShort(std::string_view text) { return HasLine(text, kEndAnnounced) && !HasLine(text, kEndMark); }

}  // namespace ed3r
