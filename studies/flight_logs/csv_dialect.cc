#include "studies/flight_logs/csv_dialect.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/line_ends.h"
#include "engine/core/message.h"

namespace ed3r::flight_logs {
namespace {

// Cells of a line, quotes respected.
std::vector<std::string_view> Cells(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != delimiter)) continue;
    cells.push_back(line.substr(begin, i - begin));
    begin = i + 1;
  }
  return cells;
}

bool IsNumber(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && error == std::errc() && stop == text.data() + text.size();
}

bool AllNumbers(const std::vector<std::string_view>& cells) {
  return std::all_of(cells.begin(), cells.end(), IsNumber);
}

std::string_view LeftTrimmed(std::string_view line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  return line.substr(begin);
}

bool IsComment(std::string_view line) {
  line = LeftTrimmed(line);
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

char DelimiterOf(std::string_view header) {
  char best = ',';
  std::size_t most = Cells(header, ',').size();
  for (const char delimiter : {';', '\t'}) {
    const std::size_t cells = Cells(header, delimiter).size();
    if (cells > most) best = delimiter, most = cells;
  }
  return best;
}

// Walks over the lines of a table and makes them standard in place.
class Standard {
 public:
  Standard(const std::string& path, std::string& text, bool skip_bad)
      : path_(path), text_(text), skip_bad_(skip_bad) {
    text_ = WithLineFeeds(std::move(text_));
  }

  void Run() {
    std::size_t next = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    for (number_ = 1; next < text_.size(); ++number_) {
      begin_ = next;
      const std::size_t newline = std::min(text_.find('\n', begin_), text_.size());
      next = newline + 1;
      std::string_view line = std::string_view(text_).substr(begin_, newline - begin_);
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (LeftTrimmed(line).empty()) continue;
      if (IsComment(line) || (columns_ == 0 && IsSeparatorLine(line)))
        LeaveOut(line);
      else if (columns_ == 0)
        ReadHeader(line);
      else
        ReadRow(line);
    }
  }

  char delimiter() const { return delimiter_; }
  int bad() const { return bad_; }
  int comment_rows() const { return comment_rows_; }

 private:
  void LeaveOut(std::string_view comment) {
    comment_rows_ += columns_ > 1 && Cells(comment, delimiter_).size() == columns_;
    text_[begin_] = '#';
  }

  bool IsSeparatorLine(std::string_view line) {
    if (line.size() != 5 || !line.starts_with("sep=")) return false;
    forced_ = line[4];
    return true;
  }

  void ReadHeader(std::string_view line) {
    delimiter_ = forced_ != 0 ? forced_ : DelimiterOf(line);
    const std::vector<std::string_view> cells = Cells(line, delimiter_);
    columns_ = cells.size();
    if (AllNumbers(cells))
      Fail("a line of numbers where the names of the columns were expected; a header line is needed");
    if (columns_ == 1 && LeftTrimmed(line).find(' ') != std::string_view::npos)
      Fail("no comma, semicolon or tab separates the names of the columns");
  }

  void ReadRow(std::string_view line) {
    const std::vector<std::string_view> cells = Cells(line, delimiter_);
    const bool open_quote = std::count(line.begin(), line.end(), '"') % 2 != 0;
    if (cells.size() == columns_ && !open_quote) return;
    if (skip_bad_) {
      text_[begin_] = '#';
      ++bad_;
    } else if (open_quote) {
      Fail(
          "a quotation mark is not closed; cells over several lines are not read; --skip-bad leaves such "
          "rows out");
    } else if (const auto numbers = std::count_if(cells.begin(), cells.end(), IsNumber);
               delimiter_ == ',' && columns_ > 1 && std::cmp_greater(numbers, columns_) &&
               cells.size() <= 2 * columns_) {
      Fail(fmt::format(
          "{} numbers, but the header names {} columns: these look like decimal commas between commas; write "
          "decimal points, or separate the columns by semicolons",
          numbers, columns_));
    } else {
      Fail(fmt::format("{} cells, but the header names {} column{}; --skip-bad leaves such rows out",
                       cells.size(), columns_, columns_ == 1 ? "" : "s"));
    }
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw UserError(OneLine(fmt::format("{}:{}:1: {}", path_, number_, what)));
  }

  const std::string& path_;
  std::string& text_;
  bool skip_bad_;
  char delimiter_ = ',', forced_ = 0;
  std::size_t columns_ = 0, begin_ = 0;
  int number_ = 1, bad_ = 0, comment_rows_ = 0;
};

}  // namespace

StandardCsv ToStandardCsv(const std::string& path, std::string text, bool skip_bad) {
  Standard standard(path, text, skip_bad);
  standard.Run();
  return {std::move(text), standard.delimiter(), standard.bad(), standard.comment_rows()};
}

}  // namespace ed3r::flight_logs
