#include "studies/paper/csv.h"

#include <fmt/format.h>

#include "engine/core/check.h"

namespace ed3r {
namespace {

class Parser {
 public:
  Parser(std::string_view text, std::string_view name) : text_(text), name_(name) {}

  std::vector<CsvRow> Rows() {
    std::vector<CsvRow> rows;
    while (at_ < text_.size()) {
      const int line = line_;
      rows.push_back(Row());
      if (rows.back().size() != rows.front().size())
        throw UserError(fmt::format("{}:{}: {} fields where the first row has {}", name_, line,
                                    rows.back().size(), rows.front().size()));
    }
    return rows;
  }

 private:
  bool AtLineEnd() const {
    return at_ == text_.size() || text_[at_] == '\n' || text_.substr(at_, 2) == "\r\n";
  }

  CsvRow Row() {
    CsvRow row = {Field()};
    while (!AtLineEnd()) {
      ++at_;  // the comma
      row.push_back(Field());
    }
    if (at_ < text_.size()) at_ += text_[at_] == '\r' ? 2 : 1;
    ++line_;
    return row;
  }

  std::string Field() {
    if (at_ < text_.size() && text_[at_] == '"') return QuotedField();
    const std::size_t start = at_;
    while (!AtLineEnd() && text_[at_] != ',') ++at_;
    return std::string(text_.substr(start, at_ - start));
  }

  std::string QuotedField() {
    const int line = line_;
    std::string field;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] != '"') {
        field += text_[at_];
        continue;
      }
      ++at_;
      if (AtLineEnd() || text_[at_] == ',') return field;
      if (text_[at_] != '"') throw UserError(fmt::format("{}:{}: text after a closing quote", name_, line_));
      field += '"';
    }
    throw UserError(fmt::format("{}:{}: a quote that is not closed", name_, line));
  }

  std::string_view text_, name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

}  // namespace

std::vector<CsvRow> ParseCsv(std::string_view text, std::string_view name) {
  return Parser(text, name).Rows();
}

std::string CsvField(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

}  // namespace ed3r
