#include "engine/schedule/batch/shell.h"

#include <algorithm>

namespace ed3r::schedule {
namespace {

bool IsPlain(char c, std::string_view others) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         others.find(c) != std::string_view::npos;
}

bool AllPlain(std::string_view text, std::string_view others) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) { return IsPlain(c, others); });
}

}  // namespace

std::string ShellWord(std::string_view text) {
  if (AllPlain(text, "._:,=@%+/-")) return std::string(text);
  std::string word = "'";
  for (const char c : text) c == '\'' ? word += "'\\''" : word += c;
  return word + "'";
}

std::string ShellWords(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    line += ShellWord(word);
  }
  return line;
}

bool IsDirectiveWord(std::string_view text) { return AllPlain(text, "._:,=@%+/[]-"); }

}  // namespace ed3r::schedule
