#include "engine/world/files/delimited_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/files/line_ends.h"
#include "engine/core/message.h"

namespace ed3r::world {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// The header's bytes [begin, end): the first line that is neither blank nor a comment.
struct Line {
  std::size_t begin, end;
};

Line FindHeader(std::string_view text) {
  std::size_t begin = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    if (!line.starts_with('#') && line.find_first_not_of(" \t\r") != std::string_view::npos)
      return {begin, end};
    begin = end + 1;
  }
  return {text.size(), text.size()};
}

std::size_t CountOutsideQuotes(std::string_view line, char wanted) {
  std::size_t count = 0;
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    count += !quoted && c == wanted;
  }
  return count;
}

char DelimiterOf(std::string_view header, const std::string& path) {
  const std::size_t commas = CountOutsideQuotes(header, ','), semicolons = CountOutsideQuotes(header, ';'),
                    tabs = CountOutsideQuotes(header, '\t');
  if (semicolons > 0 && semicolons >= std::max(commas, tabs)) return ';';
  if (tabs > 0 && tabs >= commas) return '\t';
  if (commas == 0 && CountOutsideQuotes(header.substr(0, header.find_last_not_of(" \r") + 1), ' ') > 1)
    throw UserError(
        fmt::format("{}: its cells are apart by spaces; allowed: commas, semicolons or tabs", path));
  return ',';
}

// A row whose first cell is #17 would be left out as a comment.
void CheckComments(const std::string& path, std::string_view text, const Line& header, char delimiter) {
  const std::size_t between =
      CountOutsideQuotes(text.substr(header.begin, header.end - header.begin), delimiter);
  std::size_t begin = header.end + 1;
  while (between > 0 && begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    if (line.starts_with('#') && CountOutsideQuotes(line, delimiter) == between)
      throw UserError(OneLine(fmt::format(
          "{}:{}:1: '{}' begins with # and has as many cells as the header: a row or a comment? "
          "allowed: a row that begins with another sign (the cell in quotes will do: \"#1\"), or no "
          "such line",
          path, 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n'),
          line.substr(0, line.find(delimiter)))));
    begin = end + 1;
  }
}

}  // namespace

DelimitedText ToDelimitedText(const std::string& path, std::string text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw UserError(fmt::format("{}: UTF-16 text; save it as UTF-8", path));
  if (text.find('\0') != std::string::npos)
    throw UserError(fmt::format("{}: is no text; allowed: a table with commas, semicolons or tabs", path));
  text = WithLineFeeds(std::move(text));
  const std::size_t first = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  const std::string_view told = std::string_view(text).substr(first);
  const char separator =
      told.starts_with("sep=") && told.size() > 4 && told[4] != '\n' && told[4] != '\r' ? told[4] : '\0';
  if (told.starts_with("sep=")) text[first] = '#';  // a line of spreadsheets alone
  const Line header = FindHeader(text);
  const char delimiter =
      DelimiterOf(std::string_view(text).substr(header.begin, header.end - header.begin), path);
  if (separator != '\0' && separator != delimiter)
    throw UserError(
        fmt::format("{}:1:5: sep={}: the names of the columns are parted by '{}'; correct this line", path,
                    separator == '\t' ? "TAB" : std::string(1, separator),
                    delimiter == '\t' ? "TAB" : std::string(1, delimiter)));
  CheckComments(path, text, header, delimiter);
  return {std::move(text), delimiter};
}

}  // namespace ed3r::world
