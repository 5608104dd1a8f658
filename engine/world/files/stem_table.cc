#include "engine/world/files/stem_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/message.h"
#include "engine/world/files/length_unit.h"
#include "engine/world/files/stem_map.h"
#include "engine/world/files/utm_zone.h"

namespace ed3r::world {
namespace {

struct Meaning {
  std::string_view what;
  double min_m, max_m;
  bool optional;                  // it can be estimated
  std::string_view other_tables;  // what it is called elsewhere, in lower case, between blanks
};

constexpr std::array<Meaning, kStemQuantities> kMeanings = {{
    {"the position east", -1e7, 1e7, false,
     " x east easting utm_e utm_x x_utm coord_x xcoord x_coord px gx "},
    {"the position north", -1e7, 1e7, false,
     " y north northing utm_n utm_y y_utm coord_y ycoord y_coord py gy "},
    {"the diameter at breast height", 0.001, 10, true, " dbh d diameter d130 d13 bhd dap diam dia "},
    {"the height", 0.5, 130, false, " height h ht total_height tree_height totalheight treeheight z zmax "},
    {"the crown's depth", 0.1, 130, true,
     " crown_depth cd crown_length cl crown_len crowndepth crownlength "},
    {"the crown's radius", 0.1, 30, true, " crown_radius cr radius crownradius "},
}};

constexpr double kFeetPerM = 1.0 / 0.3048;
constexpr double kInchesPerM = 1.0 / 0.0254;

constexpr std::array<StemColumn, 18> kNames = {{{"x_m", kX, 1, "m"},
                                                {"x_ft", kX, kFeetPerM, "ft"},
                                                {"y_m", kY, 1, "m"},
                                                {"y_ft", kY, kFeetPerM, "ft"},
                                                {"dbh_cm", kDiameter, 100, "cm"},
                                                {"dbh_mm", kDiameter, 1000, "mm"},
                                                {"dbh_m", kDiameter, 1, "m"},
                                                {"dbh_in", kDiameter, kInchesPerM, "in"},
                                                {"height_m", kHeight, 1, "m"},
                                                {"height_ft", kHeight, kFeetPerM, "ft"},
                                                {"crown_depth_m", kCrownDepth, 1, "m"},
                                                {"crown_depth_ft", kCrownDepth, kFeetPerM, "ft"},
                                                {"crown_base_m", kCrownDepth, 1, "m", true},
                                                {"crown_base_ft", kCrownDepth, kFeetPerM, "ft", true},
                                                {"crown_radius_m", kCrownRadius, 1, "m"},
                                                {"crown_radius_ft", kCrownRadius, kFeetPerM, "ft"},
                                                {"crown_diameter_m", kCrownRadius, 2, "m"},
                                                {"crown_diameter_ft", kCrownRadius, 2 * kFeetPerM, "ft"}}};

constexpr auto kNameTexts = [] {
  std::array<std::string_view, kNames.size()> texts;
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i] = kNames[i].name;
  return texts;
}();

std::string LowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

std::string NamesOf(StemQuantity quantity) {
  std::string names;
  for (const StemColumn& column : kNames) {
    if (column.quantity != quantity) continue;
    if (!names.empty()) names += " | ";
    names += column.name;
  }
  return names;
}

std::optional<double> ParsedNumber(std::string_view text) {
  double value = 0.0;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Nothing was measured, or a place of a local system.
bool IsMarkOrPlace(std::string_view text) {
  const std::optional<double> value = ParsedNumber(text);
  return value == -999 || value == -99;
}

// What tables have where nothing was measured.
bool IsMissing(std::string_view text) {
  constexpr std::array<std::string_view, 9> kWords = {"", "na", "nan", "n/a", "null", "none", "-", ".", "?"};
  if (std::find(kWords.begin(), kWords.end(), LowerCase(text)) != kWords.end()) return true;
  return ParsedNumber(text) == -9999 || IsMarkOrPlace(text);
}

constexpr const char* kEstimate = "'estimate_missing: conifers' (or deciduous, mixed, tropical)";

}  // namespace

StemTable::StemTable(const StemMapSpec& spec)
    : StemTable(spec, ToDelimitedText(spec.file, ReadFile(spec.file))) {}

StemTable::StemTable(const StemMapSpec& spec, DelimitedText file)
    : spec_(spec),
      table_(CsvTable::Parse(spec.file, std::move(file.text), CsvComments::kHash, file.delimiter)) {
  for (const auto& [name, header] : spec.columns) FindMapped(name, header);
  for (const StemColumn& column : kNames)
    if (where_[column.quantity].column == nullptr) FindByName(column);
  for (int q = 0; q < kStemQuantities; ++q)
    if (where_[q].column == nullptr) CheckAbsence(static_cast<StemQuantity>(q));
  CheckOneMeaning();
  std::vector<std::size_t> read;
  for (const Where& where : where_)
    if (where.column != nullptr) read.push_back(where.index);
  table_.DecimalCommasToPoints(read);
  for (const StemQuantity quantity : {kX, kY}) negative_places_[quantity] = HasNegativePlaces(quantity);
}

void StemTable::CheckOneMeaning() const {
  for (int q = 0; q < kStemQuantities; ++q)
    for (int other = 0; other < q; ++other)
      if (where_[q].column != nullptr && where_[other].column != nullptr &&
          where_[q].index == where_[other].index)
        FailAt(spec_.columns_place,
               fmt::format("forest.stem_map.columns: '{}' is both {} and {}; allowed: one meaning a column",
                           Header(static_cast<StemQuantity>(q)), kMeanings[other].what, kMeanings[q].what));
}

bool StemTable::HasNegativePlaces(StemQuantity quantity) const {
  for (std::size_t row = 0; row < table_.rows(); ++row)
    if (const std::string_view text = table_.Cell(row, where_[quantity].index); !IsMissing(text))
      if (const std::optional<double> value = ParsedNumber(text); value && *value < 0.0) return true;
  return false;
}

void StemTable::FindMapped(const std::string& name, const std::string& header) {
  for (const StemColumn& column : kNames) {
    if (column.name != name) continue;
    Where& where = where_[column.quantity];
    if (where.column != nullptr)
      FailAt(spec_.columns_place, fmt::format("forest.stem_map.columns: {} and {} are both {}; name one",
                                              name, where.column->name, kMeanings[column.quantity].what));
    where = {&column, table_.Column(header, fmt::format("forest.stem_map.columns has it as {}", name))};
    CheckUnit(column, header);
  }
}

// "height_ft" mapped as height_m.
void StemTable::CheckUnit(const StemColumn& column, const std::string& header) const {
  const std::vector<std::string> said = LengthUnitsIn(header);
  const auto is_its_own = [&](const std::string& unit) {
    const std::string_view plain = unit == "us-ft"            ? "ft"
                                   : unit.starts_with("inch") ? "in"
                                                              : std::string_view(unit);
    return plain == column.unit;
  };
  if (said.empty() || std::any_of(said.begin(), said.end(), is_its_own)) return;
  FailAt(
      spec_.columns_place,
      OneLine(fmt::format("forest.stem_map.columns: {} is '{}', whose name says {}; allowed: {}, or a name "
                          "that says the unit of its values; correct one of them",
                          column.name, header, said.back(), NamesOf(column.quantity))));
}

void StemTable::FindByName(const StemColumn& column) {
  const auto found = std::find(table_.columns().begin(), table_.columns().end(), column.name);
  if (found != table_.columns().end())
    where_[column.quantity] = {&column, static_cast<std::size_t>(found - table_.columns().begin())};
}

std::string StemTable::HeaderAmong(std::string_view words) const {
  for (const std::string& header : table_.columns())
    if (words.find(fmt::format(" {} ", LowerCase(header))) != std::string_view::npos) return header;
  return "";
}

void StemTable::CheckAbsence(StemQuantity quantity) const {
  const std::string longitude = HeaderAmong(" lon longitude lng long "),
                    latitude = HeaderAmong(" lat latitude ");
  if (quantity <= kY && !longitude.empty() && !latitude.empty()) FailDegrees(longitude, latitude);
  const Meaning& meaning = kMeanings[quantity];
  if (meaning.optional && spec_.estimate_missing) return;
  const std::string names = NamesOf(quantity);
  const std::string alike = HeaderAmong(meaning.other_tables);
  std::string advice = "name it in forest.stem_map.columns";
  if (!alike.empty())
    advice = fmt::format("is it '{1}'? Then add 'columns: {{{0}: {1}}}' to forest.stem_map, with its unit",
                         names.substr(0, names.find(' ')), alike);
  if (meaning.optional) advice += fmt::format("; or add {}", kEstimate);
  throw UserError(fmt::format("{}: no column for {} ({}); {}; columns: {}", table_.path(), meaning.what,
                              names, advice, fmt::join(table_.columns(), ", ")));
}

void StemTable::FailDegrees(const std::string& longitude, const std::string& latitude) const {
  throw UserError(fmt::format(
      "{}: '{}' and '{}' are longitude and latitude; allowed: metres or feet of a projected system: "
      "ogr2ogr -f CSV "
      "stems_utm.csv '{}' -oo X_POSSIBLE_NAMES={} -oo Y_POSSIBLE_NAMES={} -s_srs EPSG:4326 -t_srs {} -lco "
      "GEOMETRY=AS_XY, then 'columns: {{x_m: X, y_m: Y}}'",
      table_.path(), longitude, latitude, table_.path(), longitude, latitude,
      UtmZone(FirstNumber(longitude), FirstNumber(latitude))));
}

std::optional<double> StemTable::Number(std::size_t row, StemQuantity quantity) const {
  return Number(row, quantity, kMeanings[quantity].max_m);
}

std::optional<double> StemTable::CrownDepth(std::size_t row, double height_m) const {
  const StemColumn* column = where_[kCrownDepth].column;
  if (column == nullptr || !column->base)
    return Number(row, kCrownDepth, height_m);  // no deeper than the tree
  const std::optional<double> base_m = Number(row, kCrownDepth, height_m - kMeanings[kCrownDepth].min_m);
  return base_m ? std::optional(height_m - *base_m) : std::nullopt;
}

std::optional<double> StemTable::CrownRadius(std::size_t row, double height_m) const {
  constexpr double kShrubM = 3.0;
  return Number(row, kCrownRadius, std::min(kMeanings[kCrownRadius].max_m, std::max(height_m, kShrubM)));
}

std::optional<double> StemTable::Number(std::size_t row, StemQuantity quantity, double max_m) const {
  const Where& where = where_[quantity];
  if (where.column == nullptr) return std::nullopt;
  const Meaning& meaning = kMeanings[quantity];
  std::string text(table_.Cell(row, where.index));
  // A place may be -99 m or -999 m of a local system, where others are negative too.
  const bool a_place = quantity <= kY && negative_places_[quantity] && IsMarkOrPlace(text);
  if (IsMissing(text) && !a_place) {
    if (meaning.optional && spec_.estimate_missing) return std::nullopt;
    throw UserError(
        fmt::format("{}'{}' is missing; measure it or leave the tree out{}", table_.Where(row, where.index),
                    text, meaning.optional ? fmt::format(", or add {} to forest.stem_map", kEstimate) : ""));
  }
  const double per_m = where.column->per_m;
  const double min = (where.column->base ? 0.0 : meaning.min_m) * per_m, max = max_m * per_m;
  const std::optional<double> value = ParsedNumber(text);
  if (!value || !(*value >= min) || !(*value <= max))
    throw UserError(fmt::format("{}'{}' is not allowed; allowed: {:g} .. {:g} {}",
                                table_.Where(row, where.index), text, min, max, where.column->unit));
  return *value / per_m;
}

double StemTable::FirstNumber(const std::string& header) const {
  double value = 0.0;
  const std::size_t index = table_.Column(header, "a place");
  if (table_.rows() == 0) return value;
  std::string text(table_.Cell(0, index));
  std::replace(text.begin(), text.end(), ',', '.');
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::span<const std::string_view> StemColumnNames() { return kNameTexts; }

}  // namespace ed3r::world
