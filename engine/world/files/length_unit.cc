#include "engine/world/files/length_unit.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <span>

namespace ed3r::world {
namespace {

constexpr double kFootM = 0.3048;
constexpr double kSurveyFootM = 1200.0 / 3937.0;  // of the United States, until 2022

constexpr std::array<LengthUnit, 7> kUnits = {{{1.0, "m"},
                                               {kFootM, "ft"},
                                               {kSurveyFootM, "us-ft"},
                                               {0.1, "dm"},
                                               {0.01, "cm"},
                                               {0.001, "mm"},
                                               {1000.0, "km"}}};

struct Synonym {
  std::string_view word, name;
};

constexpr std::array<Synonym, 33> kSynonyms = {{{"metre", "m"},
                                                {"meter", "m"},
                                                {"metres", "m"},
                                                {"meters", "m"},
                                                {"mtr", "m"},
                                                {"foot", "ft"},
                                                {"feet", "ft"},
                                                {"foot intl", "ft"},
                                                {"intl foot", "ft"},
                                                {"international foot", "ft"},
                                                {"international feet", "ft"},
                                                {"foot international", "ft"},
                                                {"feet international", "ft"},
                                                {"foot us survey", "us-ft"},
                                                {"feet us survey", "us-ft"},
                                                {"us survey foot", "us-ft"},
                                                {"us survey feet", "us-ft"},
                                                {"survey foot", "us-ft"},
                                                {"survey feet", "us-ft"},
                                                {"foot us", "us-ft"},
                                                {"feet us", "us-ft"},
                                                {"us foot", "us-ft"},
                                                {"us feet", "us-ft"},
                                                {"ftus", "us-ft"},
                                                {"usft", "us-ft"},
                                                {"decimetre", "dm"},
                                                {"decimeter", "dm"},
                                                {"centimetre", "cm"},
                                                {"centimeter", "cm"},
                                                {"millimetre", "mm"},
                                                {"millimeter", "mm"},
                                                {"kilometre", "km"},
                                                {"kilometer", "km"}}};

// What lengths are measured in besides, by words that mean little else, and by words that do so where they end a name.
constexpr std::array<std::string_view, 6> kOthers = {"yd", "yds", "yard", "yards", "inch", "inches"};
constexpr std::array<std::string_view, 11> kOthersAtTheEnd = {
    "in", "fathom", "fathoms", "furlong", "furlongs", "chain", "chains", "nautical", "nmi", "mile", "miles"};

// What a unit is written to without a gap: "heightft". The short ones are whole names besides, as many words end in them.
constexpr std::array<std::string_view, 16> kQuantities = {
    "height", "hgt",    "elevation", "elev",  "altitude", "alt",  "dbh",     "diameter",
    "diam",   "radius", "width",     "depth", "crown",    "base", "easting", "northing"};
constexpr std::array<std::string_view, 3> kShortQuantities = {"ht", "x", "y"};

bool IsLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool IsCapital(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool IsSmall(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }

// Whether a name ends in a number that the next word belongs to: "dbh_1.3", "DBH 1.3 ", but not "DEM 2020 ". Dots are gaps,
// too: R makes "Height..ft." of "Height (ft)".
bool IsMeasure(std::string_view before) {
  const std::size_t end = before.find_last_not_of(" .") + 1;
  const std::size_t begin = before.substr(0, end).find_last_not_of("0123456789.") + 1;
  const std::string_view number = before.substr(begin, end - begin);
  const std::size_t digit = std::min(number.find_first_not_of('.'), number.size());
  return digit < number.size() && (end == before.size() || number.find('.', digit) != std::string_view::npos);
}

// The unit that a word in lower case says, or "".
std::string UnitOfWord(const std::string& word, bool ends_the_name) {
  const bool plural = word.ends_with("metres") || word.ends_with("meters");
  const std::string_view single = std::string_view(word).substr(0, word.size() - (plural ? 1 : 0));
  if (const std::optional<LengthUnit> unit = FindLengthUnit(single)) return std::string(unit->name);
  const auto is_of = [&](const auto& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  return is_of(kOthers) || (ends_the_name && is_of(kOthersAtTheEnd)) ? word : "";
}

// The unit that a word ends in behind a quantity, or "". One letter is none: dbhm may be a mean.
std::string UnitBehindQuantity(const std::string& word, bool ends_the_name) {
  for (std::size_t begin = 1; begin + 1 < word.size(); ++begin) {
    const std::string_view head = std::string_view(word).substr(0, begin);
    const bool quantity =
        std::any_of(kQuantities.begin(), kQuantities.end(),
                    [&](std::string_view name) { return head.ends_with(name); }) ||
        std::find(kShortQuantities.begin(), kShortQuantities.end(), head) != kShortQuantities.end();
    if (!quantity) continue;
    if (std::string unit = UnitOfWord(word.substr(begin), ends_the_name); !unit.empty()) return unit;
  }
  return "";
}

// "U.S._Survey-Foot " -> "us survey foot"
std::string Plain(std::string_view word) {
  std::string plain;
  for (const char c : word) {
    const bool gap = c == ' ' || c == '_' || c == '-' || c == '\t';
    if (gap && !plain.empty() && plain.back() != ' ') plain += ' ';
    if (!gap && c != '.' && c != '(' && c != ')')
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  while (plain.ends_with(' ')) plain.pop_back();
  return plain;
}

}  // namespace

std::string KnownLengthUnits() {
  std::string text;
  for (const LengthUnit& unit : kUnits) {
    if (!text.empty()) text += " | ";
    text += unit.name;
  }
  return text;
}

std::optional<LengthUnit> FindLengthUnit(std::string_view word) {
  const std::string plain = Plain(word);
  for (const LengthUnit& unit : kUnits)
    if (plain == Plain(unit.name)) return unit;
  for (const Synonym& synonym : kSynonyms)
    if (plain == synonym.word) return FindLengthUnit(synonym.name);
  return std::nullopt;
}

std::vector<std::string> LengthUnitsIn(std::string_view text) {
  std::vector<std::string> units;
  for (const bool capitals_begin : {false, true})
    for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end) {
      end = begin + 1;
      if (!IsLetter(text[begin])) continue;
      while (end < text.size() && IsLetter(text[end]) &&
             !(capitals_begin && IsCapital(text[end]) && IsSmall(text[end - 1])))
        ++end;
      const bool last = std::none_of(text.begin() + static_cast<std::ptrdiff_t>(end), text.end(),
                                     [](unsigned char c) { return std::isalnum(c) != 0; });
      const std::string word = Plain(text.substr(begin, end - begin));
      std::string unit = IsMeasure(text.substr(0, begin)) ? "" : UnitOfWord(word, last && begin > 0);
      if (unit.empty()) unit = UnitBehindQuantity(word, last);
      if (!unit.empty()) units.push_back(unit);
    }
  return units;
}

std::optional<LengthUnit> FindLengthUnit(double metres) {
  for (const LengthUnit& unit : kUnits)
    if (std::abs(metres - unit.m) <= 1e-9 * unit.m) return unit;
  return std::nullopt;
}

}  // namespace ed3r::world
