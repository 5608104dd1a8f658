#include "studies/fit/unit_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <vector>

namespace ed3r::fit {
namespace {

struct UnitWord {
  std::string_view ending;  // of the meanings whose unit it is about
  double factor;            // 1: ours; 0: none makes ours of it
  std::string_view words;   // any of them, between blanks
};

constexpr UnitWord kUnitWords[] = {{"_s", 1e-9, " ns nsec nanosecond nanoseconds "},
                                   {"_s", 1e-6, " us usec microsecond microseconds "},
                                   {"_s", 1e-3, " ms msec millisecond milliseconds "},
                                   {"_s", 1, " s sec secs second seconds "},
                                   {"_s", 60, " min mins minute minutes "},
                                   {"_s", 3600, " h hr hrs hour hours "},
                                   {"_w", 1e3, " kw kilowatt kilowatts "},
                                   {"_w", 1e-3, " mw milliwatt milliwatts "},
                                   {"_w", 745.7, " hp horsepower "},
                                   {"_w", 0, " wh kwh mwh kj joule joules "},
                                   {"_v", 1e-3, " mv millivolt millivolts "},
                                   {"_v", 1e-2, " cv centivolt centivolts "},
                                   {"_a", 1e-3, " ma milliamp milliamps milliampere milliamperes "},
                                   {"_a", 1e-2, " ca centiamp centiamps centiampere centiamperes "},
                                   {"_a", 0, " ah mah "},
                                   {"_mps", 1 / 3.6, " kph "},
                                   {"_mps", 0.44704, " mph mphr "},
                                   {"_mps", 0.514444, " kn kt kts knt knts knot knots kias kcas ktas keas "},
                                   {"_mps", 0.3048, " fps "},
                                   {"_mps", 0.00508, " fpm ftpm "},
                                   {"_mps", 0.0254, " ips inps "},
                                   {"_mps", 1.0 / 60.0, " mpm "},
                                   {"_m", 1, " m meter meters metre metres "},
                                   {"_m", 0.3048, " ft foot feet usft ftus "},
                                   {"_m", 0.9144, " yd yds yard yards "},
                                   {"_m", 1.8288, " fathom fathoms "},
                                   {"_m", 0.0254, " inch inches "},
                                   {"_m", 1852, " nmi nm nauticalmile nauticalmiles "},
                                   {"_m", 1609.344, " mi mile miles "},
                                   {"_m", 1e3, " km kilometer kilometers kilometre kilometres "},
                                   {"_m", 0.1, " dm decimeter decimeters decimetre decimetres "},
                                   {"_m", 0.01, " cm centimeter centimeters centimetre centimetres "},
                                   {"_m", 1e-3, " mm millimeter millimeters millimetre millimetres "},
                                   {"_kg", 1e-3, " g gr gram grams "},
                                   {"_kg", 0.453592, " lb lbs pound pounds "},
                                   {"_kg", 0.0283495, " oz ounce ounces "}};

// What a unit is written to without a gap: groundspeedkmh, heightft. The short ones are whole names besides, as many words
// end in them.
constexpr std::string_view kQuantities[] = {
    "speed",   "spd",      "velocity", "vel",       "climb",  "rate",    "vario", "height",
    "hgt",     "altitude", "alt",      "elevation", "elev",   "agl",     "time",  "timestamp",
    "voltage", "current",  "power",    "mass",      "weight", "payload", "load"};
constexpr std::string_view kShortQuantities = " v vs gs tas ias cas ht ";

// Whether a capital after a small letter begins a word, as in speedKmh but not in power_kW.
enum class Capitals { kPlain, kBeginWords };

// The words of a name, in lower case.
std::vector<std::string> WordsOf(std::string_view name, Capitals capitals) {
  std::vector<std::string> words(1);
  bool small = false;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    const bool begins = capitals == Capitals::kBeginWords && small && std::isupper(letter) != 0;
    if ((begins || std::isalpha(letter) == 0) && !words.back().empty()) words.emplace_back();
    if (std::isalpha(letter) != 0) words.back() += static_cast<char>(std::tolower(letter));
    small = std::islower(letter) != 0;
  }
  if (words.back().empty() && words.size() > 1) words.pop_back();
  return words;
}

// From the unit that a word says to ours for `meaning`; none for a word that says none.
std::optional<double> FactorOf(std::string_view meaning, std::string_view word) {
  if (word.empty()) return std::nullopt;
  for (const UnitWord& unit : kUnitWords)
    if (meaning.ends_with(unit.ending) &&
        unit.words.find(fmt::format(" {} ", word)) != std::string_view::npos)
      return unit.factor;
  return std::nullopt;
}

// The same of a length by a time: kmh, kmph, kmperhour. Nobody writes a craft's speed in m/h or km/s: m_h and kms are other
// words.
std::optional<double> QuotientOf(std::string_view word) {
  constexpr double kLeast = 1e-3;  // mm/s
  for (std::size_t end = word.size(); end-- > 1;) {
    const std::optional<double> metres = FactorOf("_m", word.substr(0, end));
    std::string_view time = word.substr(end);
    if (end > 2 && time == "s") continue;  // miles: a plural
    time.remove_prefix(time.starts_with("per") ? 3 : time.starts_with("p") ? 1 : 0);
    const std::optional<double> seconds = FactorOf("_s", time);
    if (!metres || !seconds) continue;
    const double factor = *metres / *seconds;
    if (factor >= kLeast && factor <= 1.0) return factor;
  }
  return std::nullopt;
}

// Another unit that a word ends in behind a quantity, and its factor. One letter is none, and dm of veldms is downwards, in
// metres.
std::optional<std::pair<std::string, double>> BehindQuantity(std::string_view meaning,
                                                             std::string_view word) {
  for (std::size_t begin = 1; begin + 1 < word.size(); ++begin) {
    const std::string_view head = word.substr(0, begin), tail = word.substr(begin);
    const bool quantity = std::any_of(std::begin(kQuantities), std::end(kQuantities),
                                      [&](std::string_view name) { return head.ends_with(name); }) ||
                          kShortQuantities.find(fmt::format(" {} ", head)) != std::string_view::npos;
    if (!quantity || tail.starts_with("dm")) continue;
    std::optional<double> factor = FactorOf(meaning, tail);
    if (!factor && meaning.ends_with("_mps")) factor = QuotientOf(tail);
    if (factor && *factor != 1.0) return std::pair{std::string(tail), *factor};
  }
  return std::nullopt;
}

// What the words from first on say as one. A letter before a whole speed is no prefix of its unit, but an axis: vel_d_m_s is
// downwards.
std::optional<std::pair<std::string, double>> OfWords(std::string_view meaning,
                                                      const std::vector<std::string>& words,
                                                      std::size_t first, std::size_t count) {
  const bool speed = meaning.ends_with("_mps");
  std::string rest;
  for (std::size_t i = 1; i < count; ++i) rest += words[first + i];
  if (const auto whole = QuotientOf(rest); whole && words[first].size() == 1) {
    if (meaning != "climb_mps" || words[first] != "d") return std::nullopt;
    return std::pair{"a rate downwards", -*whole};
  }
  const std::string word = words[first] + rest;
  std::optional<double> factor = count == 1 ? FactorOf(meaning, word) : std::nullopt;
  if (!factor && speed) factor = QuotientOf(word);
  if (factor && *factor != 1.0) return std::pair{word, *factor};
  return count == 1 ? BehindQuantity(meaning, word) : std::nullopt;
}

}  // namespace

std::optional<std::pair<std::string, double>> OtherUnit(std::string_view meaning, std::string_view name) {
  const std::size_t most_words = meaning.ends_with("_mps") ? 4 : 1;  // nautical miles per hour
  for (const Capitals capitals : {Capitals::kPlain, Capitals::kBeginWords}) {
    const std::vector<std::string> words = WordsOf(name, capitals);
    for (std::size_t count = most_words; count > 0; --count)
      for (std::size_t first = 0; first + count <= words.size(); ++first)
        if (auto other = OfWords(meaning, words, first, count)) return other;
  }
  return std::nullopt;
}

std::string FirstWord(std::string_view name) { return WordsOf(name, Capitals::kPlain).front(); }

}  // namespace ed3r::fit
