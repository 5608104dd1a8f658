#include "engine/world/length_unit.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
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

constexpr std::array<Synonym, 32> kSynonyms = {{{"metre", "m"},
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
                                                {"decimetre", "dm"},
                                                {"decimeter", "dm"},
                                                {"centimetre", "cm"},
                                                {"centimeter", "cm"},
                                                {"millimetre", "mm"},
                                                {"millimeter", "mm"},
                                                {"kilometre", "km"},
                                                {"kilometer", "km"}}};

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

std::optional<LengthUnit> FindLengthUnit(double metres) {
  for (const LengthUnit& unit : kUnits)
    if (std::abs(metres - unit.m) <= 1e-9 * unit.m) return unit;
  return std::nullopt;
}

}  // namespace ed3r::world
