// Numbers as people write them in sweep files, world files and options. Pure, any thread.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace ed3r {

inline bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Without the '+' that a number may begin with; with it where no number follows ("+-1").
inline std::string_view WithoutPlus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && (IsDigit(text[1]) || text[1] == '.');
  return plus ? text.substr(1) : text;
}

// The number that all of `text` is, or none. A 0 before another digit is refused: 010 is eight in YAML 1.1 and in C, and ten
// in YAML 1.2.
template <class T>
std::optional<T> ParseNumber(std::string_view text) {
  const std::string_view digits = text.substr(text.starts_with('-') ? 1 : 0);
  if (digits.size() > 1 && digits[0] == '0' && IsDigit(digits[1])) return std::nullopt;
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace ed3r
