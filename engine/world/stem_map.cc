#include "engine/world/stem_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>

#include "engine/core/check.h"
#include "engine/world/text_place.h"

namespace ed3r {
namespace {

struct Column {
  std::string_view name;
  double min, max;
  std::string_view unit;
};

constexpr std::array<Column, 6> kColumns = {{{"x_m", -1e7, 1e7, "m"},
                                             {"y_m", -1e7, 1e7, "m"},
                                             {"dbh_cm", 0.1, 1000, "cm"},
                                             {"height_m", 0.5, 130, "m"},
                                             {"crown_depth_m", 0.1, 130, "m"},
                                             {"crown_radius_m", 0.1, 30, "m"}}};
enum { kX, kY, kDiameter, kHeight, kCrownDepth, kCrownRadius };

struct Cell {
  std::string_view text;
  TextPlace place;
};

// Plain CSV: no quotes, as stem maps hold numbers and species codes.
std::vector<Cell> Split(std::string_view line, const std::string& file, int line_number) {
  std::vector<Cell> cells;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back({line.substr(begin, end - begin), {file, line_number, static_cast<int>(begin) + 1}});
    if (end == line.size()) return cells;
    begin = end + 1;
  }
}

std::array<std::size_t, kColumns.size()> FindColumns(const std::vector<Cell>& header) {
  std::array<std::size_t, kColumns.size()> where;
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find_if(header.begin(), header.end(),
                                    [&](const Cell& cell) { return cell.text == kColumns[i].name; });
    if (found == header.end())
      FailAt(header.front().place,
             fmt::format("no column '{}' in the header of a stem map", kColumns[i].name));
    where[i] = static_cast<std::size_t>(found - header.begin());
  }
  return where;
}

double Number(const Cell& cell, const Column& column, double max) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.text.data(), cell.text.data() + cell.text.size(), value);
  if (error != std::errc() || end != cell.text.data() + cell.text.size() || !(value >= column.min) ||
      !(value <= max))
    FailAt(cell.place, fmt::format("{}: '{}' is not allowed; allowed: {:g} .. {:g} {}", column.name,
                                   cell.text, column.min, max, column.unit));
  return value;
}

Stem ReadStem(const std::vector<Cell>& cells, const std::array<std::size_t, kColumns.size()>& where) {
  const auto number = [&](int i, double max) { return Number(cells[where[i]], kColumns[i], max); };
  Stem stem;
  stem.x_m = number(kX, kColumns[kX].max);
  stem.y_m = number(kY, kColumns[kY].max);
  stem.trunk_radius_m = number(kDiameter, kColumns[kDiameter].max) / 200.0;
  stem.height_m = number(kHeight, kColumns[kHeight].max);
  stem.crown_depth_m = number(kCrownDepth, stem.height_m);  // a crown is no deeper than its tree is high
  stem.crown_radius_m = number(kCrownRadius, kColumns[kCrownRadius].max);
  return stem;
}

void MoveToOrigin(StemMap& map, const std::string& file) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low(kInfinity, kInfinity);
  Eigen::Vector2d high = -low;
  for (const Stem& stem : map.stems) {
    low = low.cwiseMin(Eigen::Vector2d(stem.x_m, stem.y_m));
    high = high.cwiseMax(Eigen::Vector2d(stem.x_m, stem.y_m));
  }
  map.size_m = high - low;
  constexpr double kMinSideM = 10.0;
  if (map.size_m.minCoeff() < kMinSideM)
    throw UserError(fmt::format("{}: the stand measures {:g} x {:g} m; allowed: at least {:g} m a side", file,
                                map.size_m.x(), map.size_m.y(), kMinSideM));
  for (Stem& stem : map.stems) {
    stem.x_m -= low.x();
    stem.y_m -= low.y();
  }
}

}  // namespace

StemMap ReadStemMap(const std::string& file) {
  const std::string text = ReadTextFile(file);
  StemMap map;
  std::array<std::size_t, kColumns.size()> where{};
  std::size_t header_cells = 0;
  int line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line(text.data() + begin, end - begin);
    begin = end + 1;
    ++line_number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    const std::vector<Cell> cells = Split(line, file, line_number);
    if (header_cells == 0) {
      where = FindColumns(cells);
      header_cells = cells.size();
      continue;
    }
    if (cells.size() != header_cells)
      FailAt({file, line_number, 1},
             fmt::format("{} cells; allowed: {}, as in the header", cells.size(), header_cells));
    map.stems.push_back(ReadStem(cells, where));
  }
  if (map.stems.empty()) throw UserError(fmt::format("{}: no trees in this stem map", file));
  MoveToOrigin(map, file);
  return map;
}

}  // namespace ed3r
