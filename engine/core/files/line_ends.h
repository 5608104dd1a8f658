// Line ends of texts from other systems.
#pragma once

#include <cstddef>
#include <string>

namespace ed3r {

// A carriage return that no line feed follows ends a line, on old systems and in YAML, also within a file whose other lines
// end otherwise: it becomes a line feed. Places (line, column) stay right.
inline std::string WithLineFeeds(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n')) text[i] = '\n';
  return text;
}

}  // namespace ed3r
