#include "studies/fit/repeated_flights.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "engine/core/check.h"

namespace ed3r::fit {
namespace {

struct Part {
  const FlightLog* log;
  const Flight* flight;

  const std::string& File() const { return log->files[flight->table]; }
};

struct Sample {
  std::tuple<double, double, double> values;
  std::size_t part;

  auto operator<=>(const Sample&) const = default;
};

[[noreturn]] void Refuse(const Part& first, const Part& second, const FlightLog* evaluated) {
  const bool seen = second.log == evaluated && first.log != evaluated;
  throw UserError(
      fmt::format("{}{}: flight '{}' has the rows of flight '{}' of {}{}: {}; leave one of them out",
                  second.log == evaluated ? "--evaluate " : "", second.File(), second.flight->id,
                  first.flight->id, first.log == evaluated ? "--evaluate " : "", first.File(),
                  seen ? "only flights that the fit has not seen judge it" : "a flight counts once"));
}

// For each part the number of its rows that another one has too, and the first of these others.
void CheckParts(const std::vector<Part>& parts, const FlightLog* evaluated) {
  std::vector<Sample> samples;
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (const FlightRow& row : parts[p].flight->rows)
      samples.push_back({{row.time_s, row.power_w, row.airspeed_mps}, p});
  std::sort(samples.begin(), samples.end());
  std::vector<std::size_t> shared(parts.size(), 0);
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin;
    while (end < samples.size() && samples[end].values == samples[begin].values) ++end;
    for (std::size_t i = begin; i < end && samples[begin].part != samples[end - 1].part; ++i) {
      const std::size_t p = samples[i].part;
      if (static_cast<double>(++shared[p]) <= kSameShare * static_cast<double>(parts[p].flight->rows.size()))
        continue;
      const std::size_t other = samples[samples[begin].part == p ? end - 1 : begin].part;
      Refuse(parts[std::min(p, other)], parts[std::max(p, other)], evaluated);
    }
    begin = end;
  }
}

}  // namespace

void CheckNoFlightTwice(const FlightLog& fitted, const FlightLog* evaluated) {
  std::vector<Part> parts;
  for (const Flight& flight : fitted.flights) parts.push_back({&fitted, &flight});
  if (evaluated != nullptr)
    for (const Flight& flight : evaluated->flights) parts.push_back({evaluated, &flight});
  CheckParts(parts, evaluated);
}

}  // namespace ed3r::fit
