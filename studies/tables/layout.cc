#include "studies/tables/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace ed3r::tables {
namespace {

constexpr int kGap = 2;

}  // namespace

int DisplayWidth(std::string_view utf8) {
  // Every byte but the continuation bytes (10xxxxxx) starts a character.
  return static_cast<int>(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string Pad(std::string_view text, int width, Align align) {
  const int space = std::max(0, width - DisplayWidth(text));
  const int left = align == Align::kLeft ? 0 : align == Align::kRight ? space : space / 2;
  return std::string(left, ' ') + std::string(text) + std::string(space - left, ' ');
}

TextColumn::TextColumn(std::span<const std::string> texts, int least) : width_(least) {
  for (const std::string& text : texts)
    width_ = std::max(width_, std::min(DisplayWidth(text) + kGap, kWidestColumn));
}

std::string TextColumn::operator()(std::string_view text) const {
  return Pad(std::string(text) + std::string(kGap, ' '), width_, Align::kLeft);
}

std::string Rule(int count) {
  std::string rule;
  for (int i = 0; i < count; ++i) rule += "─";
  return rule;
}

std::string Wrap(std::string_view text, std::string_view first, int width) {
  std::string lines, line(first);
  const std::string indent(DisplayWidth(first), ' ');
  bool empty = true;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) {
    if (!empty && DisplayWidth(line) + 1 + DisplayWidth(word) > width) {
      lines += line + '\n';
      line = indent;
      empty = true;
    }
    if (!empty) line += ' ';
    line += word;
    empty = false;
  }
  return lines + line + '\n';
}

std::string TrimLineEnds(std::string_view text) {
  std::string trimmed;
  for (const char c : text) {
    if (c == '\n') trimmed.erase(trimmed.find_last_not_of(' ') + 1);
    trimmed += c;
  }
  return trimmed;
}

std::string FormatValue(double value, int decimals) {
  if (std::isnan(value)) return "–";
  constexpr std::size_t kMostCharacters = 5;
  std::string text = fmt::format("{:.{}f}", value, decimals);
  while (text.size() > kMostCharacters && decimals > 0) text = fmt::format("{:.{}f}", value, --decimals);
  return text;
}

}  // namespace ed3r::tables
