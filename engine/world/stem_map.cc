#include "engine/world/stem_map.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>

#include "engine/core/check.h"
#include "engine/core/csv_table.h"

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

class StemReader {
 public:
  explicit StemReader(const std::string& file) : table_(CsvTable::Read(file, CsvComments::kHash)) {
    for (std::size_t i = 0; i < kColumns.size(); ++i)
      where_[i] = table_.Column(kColumns[i].name, "a stem map has it");
  }

  std::size_t Rows() const { return table_.rows(); }

  Stem Read(std::size_t row) const {
    Stem stem;
    stem.x_m = Number(row, kX, kColumns[kX].max);
    stem.y_m = Number(row, kY, kColumns[kY].max);
    stem.trunk_radius_m = Number(row, kDiameter, kColumns[kDiameter].max) / 200.0;
    stem.height_m = Number(row, kHeight, kColumns[kHeight].max);
    stem.crown_depth_m =
        Number(row, kCrownDepth, stem.height_m);  // a crown is no deeper than its tree is high
    stem.crown_radius_m = Number(row, kCrownRadius, kColumns[kCrownRadius].max);
    return stem;
  }

 private:
  double Number(std::size_t row, std::size_t i, double max) const {
    const Column& column = kColumns[i];
    const std::string_view text = table_.Cell(row, where_[i]);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= column.min) || !(value <= max))
      throw UserError(fmt::format("{}'{}' is not allowed; allowed: {:g} .. {:g} {}",
                                  table_.Where(row, where_[i]), text, column.min, max, column.unit));
    return value;
  }

  CsvTable table_;
  std::array<std::size_t, kColumns.size()> where_{};
};

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
  const StemReader reader(file);
  if (reader.Rows() == 0) throw UserError(fmt::format("{}: no trees in this stem map", file));
  StemMap map;
  for (std::size_t row = 0; row < reader.Rows(); ++row) map.stems.push_back(reader.Read(row));
  MoveToOrigin(map, file);
  return map;
}

}  // namespace ed3r
