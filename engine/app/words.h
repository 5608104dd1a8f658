// Small words of what the commands say.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/suggest.h"

namespace ed3r::app {

// "1 thread", "2 threads"
inline std::string Counted(std::int64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

// "; did you mean rbs?", or "" when no known word is near.
inline std::string DidYouMean(std::string_view word, const std::vector<std::string>& known) {
  const std::string nearest = NearestWord(word, known);
  return nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest);
}

// One line to standard error. Where that cannot be written the line is lost, and nothing else: fmt::print would throw.
template <class... Values>
void Tell(fmt::format_string<Values...> format, Values&&... values) {
  fmt::memory_buffer line;  // needs no memory for a short one
  fmt::format_to(std::back_inserter(line), format, std::forward<Values>(values)...);
  line.push_back('\n');
  std::fwrite(line.data(), 1, line.size(), stderr);
}

inline void TellNotes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) Tell("note: {}", note);
}

// What was printed goes out before what the other stream says. Where it cannot, the end of the program tells why.
void FlushOutput();

}  // namespace ed3r::app
