// From a record's Describe() to SQL and back: the columns of a table, the insert, the read and the bytes of
// the digest all walk that one description, so they cannot disagree. A column is INTEGER (int64) or REAL
// (double).
//
// What SQLite cannot keep is settled here, once: NaN is NULL in the file and comes back as the quiet NaN, and
// -0.0 comes back as 0.0. Everything else, infinities and denormals included, comes back bit for bit.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/core/sha256.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// The value that comes back when `value` was stored.
inline double Canonical(double value) {
  if (std::isnan(value)) return std::numeric_limits<double>::quiet_NaN();
  return value == 0.0 ? 0.0 : value;
}

struct Column {
  std::string name;
  bool is_real = false;
};

template <class Record>
std::vector<Column> ColumnsOf() {
  std::vector<Column> columns;
  Record record;
  Record::Describe(record, [&](std::string_view name, auto& field) {
    using Field = std::remove_cvref_t<decltype(field)>;
    static_assert(std::is_same_v<Field, std::int64_t> || std::is_same_v<Field, double>);
    columns.push_back({std::string(name), std::is_same_v<Field, double>});
  });
  return columns;
}

// "k, command_dx_m, ..."
template <class Record>
std::string ColumnNames() {
  std::string names;
  for (const Column& column : ColumnsOf<Record>()) names += (names.empty() ? "" : ", ") + column.name;
  return names;
}

// "k INTEGER NOT NULL, command_dx_m REAL, ...": only a REAL may be NULL, and then it is NaN.
template <class Record>
std::string ColumnDefinitions() {
  std::string definitions;
  for (const Column& column : ColumnsOf<Record>())
    definitions +=
        (definitions.empty() ? "" : ", ") + column.name + (column.is_real ? " REAL" : " INTEGER NOT NULL");
  return definitions;
}

// "?, ?, ..." for `keys` key columns and then every column of the record.
template <class Record>
std::string Placeholders(int keys) {
  std::string marks = "?";
  for (std::size_t i = 1; i < keys + ColumnsOf<Record>().size(); ++i) marks += ", ?";
  return marks;
}

// The value that a column has in a file that was written before there was such a column: the field's initial value.
template <class Record>
std::vector<std::string> DefaultLiterals() {
  std::vector<std::string> literals;
  const Record record;
  Record::Describe(record, [&](std::string_view, const auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
      literals.push_back(std::isnan(field) ? "NULL" : fmt::format("{:#.17g}", field));
    else
      literals.push_back(fmt::format("{}", field));
  });
  return literals;
}

// Binds every column of the record, from parameter `next` on.
template <class Record>
void BindColumns(Statement& statement, int next, const Record& record) {
  Record::Describe(record, [&](std::string_view, const auto& field) { statement.Bind(next++, field); });
}

// Reads every column of the record, from column `next` on.
template <class Record>
void ReadColumns(const Statement& statement, int next, Record& record) {
  Record::Describe(record, [&](std::string_view, auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
      field = statement.Real(next++);
    else
      field = statement.Int(next++);
  });
}

// Writes eight bytes, least significant first, whatever the machine's order.
inline void PutInt(char* bytes, std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  for (int i = 0; i < 8; ++i) bytes[i] = static_cast<char>(bits >> (8 * i));
}

inline void AppendInt(std::string& bytes, std::int64_t value) {
  char little[8];
  PutInt(little, value);
  bytes.append(little, sizeof little);
}

// SHA-256 in hexadecimal.
inline std::string HashOf(std::string_view bytes) {
  Sha256 sha;
  sha.Update(bytes);
  return sha.Hex();
}

inline void AppendText(std::string& bytes, std::string_view text) {
  AppendInt(bytes, static_cast<std::int64_t>(text.size()));
  bytes.append(text);
}

// Appends every column in its canonical form, which is the same before storing and after reading back.
template <class Record>
void AppendColumns(std::string& bytes, const Record& record) {
  Record::Describe(record, [&](std::string_view, const auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
      AppendInt(bytes, std::bit_cast<std::int64_t>(Canonical(field)));
    else
      AppendInt(bytes, field);
  });
}

// The columns of Record that a file has, in the file's order. Code that knows more of them reads the file all the same,
// and its checksums are over these.
template <class Record>
class StoredColumns {
 public:
  // `names` as the file has them. `unknown` is the first that Record does not have, "" where it knows all.
  explicit StoredColumns(const std::vector<std::string>& names) {
    const std::vector<Column> known = ColumnsOf<Record>();
    const std::vector<std::string> literals = DefaultLiterals<Record>();
    for (std::size_t i = 0; i < known.size(); ++i) {
      const bool stored = std::find(names.begin(), names.end(), known[i].name) != names.end();
      selection_ += (i == 0 ? "" : ", ") + (stored ? known[i].name : literals[i]);
      complete_ = complete_ && stored;
    }
    for (const std::string& name : names) {
      const auto at =
          std::find_if(known.begin(), known.end(), [&](const Column& c) { return c.name == name; });
      if (at == known.end()) {
        if (unknown_.empty()) unknown_ = name;
        continue;
      }
      order_.push_back(static_cast<std::size_t>(at - known.begin()));
      names_ += (names_.empty() ? "" : ", ") + name;
    }
  }

  const std::string& unknown() const { return unknown_; }
  bool complete() const { return complete_; }
  const std::string& names() const { return names_; }  // "k, command_dx_m, ..."
  // What to select for ReadColumns: a column that the file lacks is its default.
  const std::string& selection() const { return selection_; }

  // As AppendColumns, of the stored columns alone and in their order.
  void Append(std::string& bytes, const Record& record) const {
    std::array<std::int64_t, kMostColumns> values;
    std::size_t count = 0;
    Record::Describe(record, [&](std::string_view, const auto& field) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
        values.at(count++) = std::bit_cast<std::int64_t>(Canonical(field));
      else
        values.at(count++) = field;
    });
    const std::size_t before = bytes.size();
    bytes.resize(before + 8 * order_.size());
    char* next = bytes.data() + before;
    for (const std::size_t i : order_) {
      PutInt(next, values[i]);
      next += 8;
    }
  }

 private:
  static constexpr std::size_t kMostColumns = 256;

  std::string unknown_, names_, selection_;
  bool complete_ = true;
  std::vector<std::size_t> order_;
};

}  // namespace ed3r::store
