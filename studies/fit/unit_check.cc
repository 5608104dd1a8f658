#include "studies/fit/unit_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/core/check.h"
#include "studies/fit/unit_names.h"

namespace ed3r::fit {
namespace {

double Quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::optional<std::string> ColumnThatBegins(const flight_logs::LogTable& table, std::string_view a,
                                            std::string_view b) {
  for (const std::string& name : table.columns()) {
    const std::string first = FirstWord(name);
    if (first.starts_with(a) || (!b.empty() && first.starts_with(b))) return name;
  }
  return std::nullopt;
}

std::optional<std::string> LatitudeOf(const flight_logs::LogTable& table) {
  return ColumnThatBegins(table, "lat", "");
}

std::optional<std::string> LongitudeOf(const flight_logs::LogTable& table) {
  return ColumnThatBegins(table, "lon", "lng");
}

class UnitCheck {
 public:
  UnitCheck(const flight_logs::LogTable& table, const LogFormat& format) : table_(table), format_(format) {}

  void Run() const {
    for (const auto& [meaning, column] : format_.columns) CheckName(meaning, column);
    CheckTime();
    CheckTimeOfDay();
    constexpr double kFastMps = 25.0, kFastClimbMps = 15.0;
    CheckSpeed("airspeed_mps", kFastMps);
    CheckSpeed("ground_speed_mps", kFastMps);
    CheckSize("climb_mps", kFastClimbMps, "m/s", {{"cm/s", 0.01}, {"ft/min", 0.00508}});
    CheckSize("voltage_v", 150.0, "V", {{"mV", 1e-3}});
    CheckSize("current_a", 1000.0, "A", {{"hundredths of an ampere", 0.01}, {"mA", 1e-3}});
    CheckSize("mass_kg", 50.0, "kg", {{"g", 1e-3}});
    CheckSize("payload_kg", 3.0 * format_.robot.mass_kg,
              fmt::format("kg on an airframe of {:g} kg", format_.robot.mass_kg), {{"g", 1e-3}});
    CheckRates();
    CheckPath();
  }

 private:
  struct Guess {
    const char* unit;
    double factor;
  };

  bool Believed(const std::string& meaning) const {
    return !format_.Has(meaning) || format_.units.contains(meaning);
  }

  // The cells of a column that are numbers, NaN for the others: those are refused where the rows are read.
  std::vector<double> Values(const std::string& name, const std::string& what) const {
    const std::size_t column = table_.Column(name, what);
    std::vector<double> values;
    values.reserve(table_.rows());
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      double value = NAN;
      try {
        value = table_.Number(row, column, -1e300, 1e300);
      } catch (const UserError&) {
      }
      values.push_back(value);
    }
    return values;
  }

  std::vector<double> Sizes(const std::string& meaning) const {
    std::vector<double> sizes;
    for (const double value : Values(format_.columns.at(meaning), meaning))
      if (!std::isnan(value)) sizes.push_back(std::abs(value));
    return sizes;
  }

  [[noreturn]] void Refuse(const std::string& meaning, const std::string& what,
                           const std::string& mend) const {
    const std::string& column = format_.columns.at(meaning);
    const std::string head = table_.kind() == flight_logs::LogKind::kCsv ? ":1:1" : "";
    throw UserError(fmt::format("{}{}: {} ('{}'): {}; {}", table_.path(), head, meaning, column, what, mend));
  }

  static std::string Mend(const std::string& meaning, const std::vector<Guess>& guesses) {
    std::string text = "it looks like ";
    for (std::size_t i = 0; i < guesses.size(); ++i)
      text += fmt::format("{}{}: put 'units: {{{}: {:.6g}}}' into the format file",
                          i == 0 ? "" : ", or like ", guesses[i].unit, meaning, guesses[i].factor);
    return text + fmt::format(" ({}: 1 if the values are right)", meaning);
  }

  void CheckName(const std::string& meaning, const std::string& column) const {
    if (Believed(meaning)) return;
    const auto unit = OtherUnit(meaning, column);
    if (!unit) return;
    const auto& [word, factor] = *unit;
    const std::string what = fmt::format("the name says {}", word);
    if (factor != 0.0) Refuse(meaning, what, Mend(meaning, {{word.c_str(), factor}}));
    Refuse(meaning, what,
           fmt::format("no factor makes {} of that: name another column ('units: {{{}: 1}}' if it is right)",
                       meaning, meaning));
  }

  void CheckTime() const {
    constexpr double kShortest = 0.004, kLongest = 2.0;  // a step of a log that can be integrated
    if (Believed("time_s")) return;
    const std::vector<double> times = Values(format_.columns.at("time_s"), "time_s");
    std::vector<double> steps;
    for (std::size_t i = 1; i < times.size(); ++i)
      if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
    if (steps.empty()) return;
    const double step = Quantile(steps, 0.5);
    if (step >= kShortest && step <= kLongest) return;
    for (const Guess& guess : {Guess{"milliseconds", 1e-3},
                               {"microseconds", 1e-6},
                               {"nanoseconds", 1e-9},
                               {"minutes", 60.0},
                               {"hours", 3600.0},
                               {"days", 86400.0}}) {
      const double as_guessed = step * guess.factor;
      if (as_guessed < (guess.factor > 1.0 ? 0.03 : kShortest) || as_guessed > kLongest) continue;
      constexpr double kSlowestLogS = 60.0;
      Refuse("time_s", fmt::format("the median step is {:g} s", step),
             Mend("time_s", {guess}) +
                 (step > kLongest && step <= kSlowestLogS
                      ? fmt::format("; a log of one row in {:g} s is too coarse, {:g} s are allowed", step,
                                    kLongest)
                      : ""));
    }
    if (step > kLongest)
      Refuse("time_s", fmt::format("the median step is {:g} s", step),
             fmt::format("nothing is integrated over more than {:g} s; a log of a higher rate is needed",
                         kLongest));
  }

  // 115859 and then 115900: the clock leaps by 40 whenever a minute is full, by 4000 more at an hour, and never otherwise
  // beyond a hundred.
  void CheckTimeOfDay() const {
    constexpr double kHundred = 100.0, kMinute = 60.0, kHour = 1e4;
    constexpr int kFewest = 2;
    if (Believed("time_s")) return;
    const std::vector<double> times = Values(format_.columns.at("time_s"), "time_s");
    int minutes = 0;
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (std::floor(times[i] / kHundred) == std::floor(times[i - 1] / kHundred)) continue;
      const bool hour = std::floor(times[i] / kHour) != std::floor(times[i - 1] / kHour);
      const double leap = times[i] - times[i - 1] - 0.4 * (kHundred + (hour ? kHour : 0.0));
      if (!(std::fmod(times[i - 1], kHundred) < kMinute) || !(leap > 0.0 && leap < kMinute)) return;
      ++minutes;
    }
    if (minutes >= kFewest)
      Refuse("time_s",
             fmt::format("it leaps by 40 whenever it reaches 60 beyond a hundred, {} times", minutes),
             "it looks like a time of day, hhmmss: seconds are wanted");
  }

  void CheckSpeed(const std::string& meaning, double fast_mps) const {
    CheckSize(meaning, fast_mps, "m/s", {{"km/h", 1 / 3.6}, {"mph", 0.44704}});
  }

  // Largest |change of a column| / (change of time) over kLag rows but for one in a hundred; 0 where there are none.
  double RateOf(const std::vector<double>& time, const std::string& meaning) const {
    constexpr std::size_t kLag = 5;
    constexpr double kLongest = 2.0;
    const std::vector<double> values = Values(format_.columns.at(meaning), meaning);
    std::vector<double> rates;
    for (std::size_t i = kLag; i < time.size(); ++i) {
      const double dt = time[i] - time[i - kLag], change = std::abs(values[i] - values[i - kLag]);
      if (dt > 0.0 && dt <= kLongest && std::isfinite(change)) rates.push_back(change / dt);
    }
    const double unit = format_.units.contains(meaning) ? format_.units.at(meaning) : 1.0;
    return rates.empty() ? 0.0 : std::abs(unit) * Quantile(rates, 0.99);
  }

  // A time in minutes has steps that a fast logger could have, but no craft climbs or gathers speed that fast.
  void CheckRates() const {
    constexpr double kFastClimbMps = 30.0, kFastMps2 = 60.0;
    if (Believed("time_s")) return;
    const std::vector<double> time = Values(format_.columns.at("time_s"), "time_s");
    const std::string speed = format_.Has("airspeed_mps") ? "airspeed_mps" : "ground_speed_mps";
    const double climb_mps = format_.Has("altitude_m") ? RateOf(time, "altitude_m") : 0.0;
    const double acceleration_mps2 = RateOf(time, speed);
    if (climb_mps > kFastClimbMps)
      Refuse("time_s", fmt::format("the altitude changes by {:.3g} m/s", climb_mps),
             Mend("time_s", {{"minutes", 60.0}}));
    if (acceleration_mps2 > kFastMps2)
      Refuse("time_s", fmt::format("the speed changes by {:.3g} m/s^2", acceleration_mps2),
             Mend("time_s", {{"minutes", 60.0}}));
  }

  // One value in a hundred above `most` is no bad cell any more.
  void CheckSize(const std::string& meaning, double most, const std::string& unit,
                 const std::vector<Guess>& guesses) const {
    if (Believed(meaning)) return;
    const std::vector<double> sizes = Sizes(meaning);
    if (sizes.empty()) return;
    const double large = Quantile(sizes, 0.99);
    if (large > most)
      Refuse(meaning, fmt::format("one value in a hundred is {:g} {} and more", large, unit),
             Mend(meaning, guesses));
  }

  // The way along latitude and longitude against the integral of the ground speed, over steps that are long against the
  // receiver's noise.
  void CheckPath() const {
    constexpr double kStepS = 2.0, kMaxStepS = 6.0, kLeastWayM = 100.0, kEarthM = 6.371e6,
                     kRad = std::numbers::pi / 180.0;
    if (Believed("ground_speed_mps") || format_.Has("flight")) return;
    const auto lat_name = LatitudeOf(table_), lon_name = LongitudeOf(table_);
    if (!lat_name || !lon_name) return;
    const std::vector<double> time = Values(format_.columns.at("time_s"), "time_s"),
                              lat = Values(*lat_name, "latitude"), lon = Values(*lon_name, "longitude"),
                              speed = Values(format_.columns.at("ground_speed_mps"), "ground_speed_mps");
    const double second = format_.units.contains("time_s") ? format_.units.at("time_s") : 1.0;
    double way_m = 0.0, integral_m = 0.0, step_integral = 0.0;
    std::size_t from = 0;
    for (std::size_t i = 1; i < time.size(); ++i) {
      step_integral += 0.5 * (speed[i] + speed[i - 1]) * (time[i] - time[i - 1]) * second;
      const double dt = (time[i] - time[from]) * second;
      if (dt < kStepS) continue;
      const double north = (lat[i] - lat[from]) * kRad * kEarthM,
                   east = (lon[i] - lon[from]) * kRad * kEarthM * std::cos(lat[i] * kRad);
      const double step_m = std::hypot(north, east);
      if (dt <= kMaxStepS && std::abs(lat[i]) <= 90.0 && std::isfinite(step_m) &&
          std::isfinite(step_integral)) {
        way_m += step_m;
        integral_m += step_integral;
      }
      from = i;
      step_integral = 0.0;
    }
    if (way_m < kLeastWayM || integral_m <= 0.0) return;
    const double ratio = way_m / integral_m;
    for (const Guess& guess :
         {Guess{"km/h", 1 / 3.6}, {"mph", 0.44704}, {"knots", 0.514444}, {"ft/s", 0.3048}, {"cm/s", 0.01}})
      if (std::abs(ratio / guess.factor - 1.0) < 0.06)
        Refuse("ground_speed_mps",
               fmt::format("'{}' and '{}' go {:.0f} m while the speed goes {:.0f} m", *lat_name, *lon_name,
                           way_m, integral_m),
               Mend("ground_speed_mps", {guess}));
  }

  const flight_logs::LogTable& table_;
  const LogFormat& format_;
};

// A recorded rate that hardly moves where the altitude does.
void CheckClimbMoves(const std::string& column, const LogFormat& format, double recorded_mps,
                     double slope_mps) {
  constexpr double kDead = 0.05, kSurelyMps = 0.3;  // a barometer's noise has slopes, too
  if (slope_mps < kSurelyMps || recorded_mps >= kDead * slope_mps) return;
  throw UserError(
      fmt::format("{} is {:.2g} m/s on average (root mean square) while the altitude ('{}') changes by "
                  "{:.2g} m/s: it was not "
                  "measured; put 'climb_from: altitude' into the format file",
                  column, recorded_mps, format.columns.at("altitude_m"), slope_mps));
}

}  // namespace

std::vector<std::string> NumberColumns(const flight_logs::LogTable& table, const LogFormat& format) {
  std::vector<std::string> names;
  for (const auto& [meaning, column] : format.columns)
    if (meaning != "flight") names.push_back(column);
  for (const auto& [column, condition] : format.in_flight)
    if (condition.words.empty()) names.push_back(column);
  for (const auto& place : {LatitudeOf(table), LongitudeOf(table)})
    if (place && format.Has("ground_speed_mps")) names.push_back(*place);
  return names;
}

void CheckUnits(const flight_logs::LogTable& table, const LogFormat& format) {
  UnitCheck(table, format).Run();
}

void CheckClimbAgainstAltitude(const std::string& where, const LogFormat& format,
                               const std::vector<double>& recorded_mps,
                               const std::vector<double>& slope_mps) {
  constexpr std::size_t kLeastRows = 50;
  constexpr double kLeastClimbMps = 0.2;  // root mean square
  constexpr double kAgainst = -0.5, kTogether = 0.8;
  const double n = static_cast<double>(recorded_mps.size());
  double cc = 0.0, ss = 0.0, cs = 0.0;
  for (std::size_t i = 0; i < recorded_mps.size(); ++i) {
    cc += recorded_mps[i] * recorded_mps[i];
    ss += slope_mps[i] * slope_mps[i];
    cs += recorded_mps[i] * slope_mps[i];
  }
  if (recorded_mps.size() < kLeastRows || std::sqrt(ss / n) < kLeastClimbMps) return;
  const double factor = format.units.contains("climb_mps") ? format.units.at("climb_mps") : 1.0;
  const std::string column = fmt::format("{}climb_mps ('{}')", where, format.columns.at("climb_mps"));
  CheckClimbMoves(column, format, std::sqrt(cc / n), std::sqrt(ss / n));
  if (cc <= 0.0) return;
  const double correlation = cs / std::sqrt(cc * ss), ratio = cs / cc;
  if (correlation < kAgainst)
    throw UserError(
        fmt::format("{} runs against the altitude ('{}'): correlation {:.2f}; upwards must be positive; it "
                    "looks like a rate that is "
                    "positive downwards: put 'units: {{climb_mps: {:g}}}' into the format file",
                    column, format.columns.at("altitude_m"), correlation, -factor));
  if (correlation < kTogether) return;
  struct Guess {
    const char *what, *meaning;
    double ratio, factor;
  };
  for (const Guess& guess : {Guess{"a climb rate in km/h", "climb_mps", 1 / 3.6, 1 / 3.6},
                             {"a climb rate in mph", "climb_mps", 0.44704, 0.44704},
                             {"a climb rate in cm/s", "climb_mps", 0.01, 0.01},
                             {"a climb rate in ft/min", "climb_mps", 0.00508, 0.00508},
                             {"a climb rate in ft/s", "climb_mps", 0.3048, 0.3048},
                             {"an altitude in feet", "altitude_m", 3.28084, 0.3048},
                             {"an altitude in cm", "altitude_m", 100.0, 0.01},
                             {"a time in minutes", "time_s", 60.0, 60.0}})
    if (std::abs(ratio / guess.ratio - 1.0) < 0.04)
      throw UserError(fmt::format(
          "{}: the altitude ('{}') changes {:.3g} times as fast; it looks like {}: put 'units: {{{}: "
          "{:.6g}}}' into the "
          "format file",
          column, format.columns.at("altitude_m"), ratio, guess.what, guess.meaning,
          guess.factor * (format.units.contains(guess.meaning) ? format.units.at(guess.meaning) : 1.0)));
  if (ratio < 0.4 || ratio > 2.5)
    throw UserError(
        fmt::format("{}: the altitude ('{}') changes {:.3g} times as fast; the units of the climb rate, the "
                    "altitude or the time are "
                    "not what they are taken for (format: units)",
                    column, format.columns.at("altitude_m"), ratio));
}

}  // namespace ed3r::fit
