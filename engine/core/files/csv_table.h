// A strict reader for CSV files of numbers: every complaint names file, line, character column and column name.
//
// Own code because Debian's CSV libraries do not fit: libcsv reports no positions, fast-cpp-csv-parser fixes
// the columns at compile time, GDAL's driver repairs what should be refused. Numbers are read by
// std::from_chars. RFC 4180 without quoted line breaks; a byte-order mark, CRLF and blank lines at the end
// are accepted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r {

// kHash is for tables of other programs: lines that begin with # are left out, blank ones too, wherever they stand, and
// so are rows without a word at the end; a column without a name (row numbers, a delimiter at the end of every line) is
// called by its place, "column 1".
enum class CsvComments { kNone, kHash };

inline constexpr std::size_t kMaxCsvColumns = 10000;

// Once read, and its decimal commas with it, nothing changes it; share it between threads freely.
class CsvTable {
 public:
  // Throws UserError: unreadable or empty file, a repeated column name, an empty one but with kHash, a row with another number of
  // cells, more than kMaxCsvColumns columns or kMaxTextBytes (file.h).
  static CsvTable Read(const std::string& path, CsvComments comments = CsvComments::kNone);
  // The same from text; `path` only names it in messages. `delimiter`: between cells; a semicolon or a tab.
  static CsvTable Parse(std::string path, std::string text, CsvComments comments = CsvComments::kNone,
                        char delimiter = ',');

  CsvTable(CsvTable&&) = default;

  // Where semicolons or tabs are between the cells, decimal commas of the numbers in these columns become points; words
  // keep theirs. To be called with all columns that are read as numbers, for they tell of each other: throws UserError
  // where thousands may be meant, which is where some have points and some commas, or three digits after every comma
  // (0,125 and 1234,125 are no thousands).
  void DecimalCommasToPoints(const std::vector<std::size_t>& columns);

  const std::string& path() const { return path_; }
  const std::vector<std::string>& columns() const { return columns_; }
  std::size_t rows() const { return row_line_.size(); }
  int Line(std::size_t row) const { return row_line_[row]; }

  // Index of a column. Throws UserError with the columns there are and the nearest name; `what` says what the
  // column is for.
  std::size_t Column(std::string_view name, std::string_view what) const;

  std::string_view Cell(std::size_t row, std::size_t column) const;
  // A cell as it was before CsvField wrote it: with its doubled quotes undone.
  std::string Text(std::size_t row, std::size_t column) const;
  // Throws UserError unless the cell is one finite number within [min, max].
  double Number(std::size_t row, std::size_t column, double min, double max) const;

  // "path:line:character: column: " for complaints about one cell.
  std::string Where(std::size_t row, std::size_t column) const;

 private:
  struct Span {
    std::uint32_t begin, end;
  };

  CsvTable() = default;
  void ReadHeader(std::string_view line, int number, CsvComments comments);
  void ReadRow(std::size_t begin, std::string_view line, int number);
  void DropBlankRowsAtEnd();

  std::string path_;
  std::string text_;
  char delimiter_ = ',';
  int header_line_ = 1;
  std::vector<std::string> columns_;
  std::vector<Span> cells_;  // rows x columns, into text_
  std::vector<std::size_t> row_begin_;
  std::vector<int> row_line_;
};

// One field as it is written, in quotes where it must be.
std::string CsvField(std::string_view text);

}  // namespace ed3r
