#include "studies/fit/repeated_flights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/check.h"

namespace ed3r::fit {
namespace {

struct Part {
  const FlightLog* log;
  const Flight* flight;

  const std::string& File() const { return log->files[flight->table]; }
};

// What a copy has of a row, and when.
struct Sample {
  double power_w, airspeed_mps, time_s;
  std::size_t part;

  // NOLINTNEXTLINE(modernize-use-nullptr): it takes <=> for a pointer's
  auto operator<=>(const Sample&) const = default;
};

// Stamps that were rounded move by less: rows would meet otherwise.
double HalfStepS(const Flight& flight) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < flight.rows.size(); ++i)
    steps.push_back(flight.rows[i].time_s - flight.rows[i - 1].time_s);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  constexpr double kRounding = 1e-6;  // of sums of decimal fractions
  return 0.5 * *middle * (1.0 + kRounding);
}

// `zero_s`: what each part's clock is taken to begin with.
std::vector<Sample> SamplesOf(const std::vector<Part>& parts, const std::vector<double>& zero_s) {
  std::vector<Sample> samples;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::vector<FlightRow>& rows = parts[p].flight->rows;
    for (const FlightRow& row : rows)
      samples.push_back({row.power_w, row.airspeed_mps, row.time_s - zero_s[p], p});
  }
  std::sort(samples.begin(), samples.end());
  return samples;
}

// The part of the next sample on one side that has the same numbers at the same time and is another's.
std::optional<std::size_t> OtherBeside(const std::vector<Sample>& samples, std::size_t i, int side,
                                       double most_s) {
  const Sample& own = samples[i];
  for (std::size_t k = i + static_cast<std::size_t>(side); k < samples.size();
       k += static_cast<std::size_t>(side)) {
    const Sample& other = samples[k];
    if (other.power_w != own.power_w || other.airspeed_mps != own.airspeed_mps ||
        std::abs(other.time_s - own.time_s) > most_s)
      break;
    if (other.part != own.part) return other.part;
  }
  return std::nullopt;
}

[[noreturn]] void Refuse(const Part& first, const Part& second, const FlightLog* evaluated) {
  const bool seen = second.log == evaluated && first.log != evaluated;
  throw UserError(
      fmt::format("{}{}: flight '{}' has the rows of flight '{}' of {}{}: {}; leave one of them out",
                  second.log == evaluated ? "--evaluate " : "", second.File(), second.flight->id,
                  first.flight->id, first.log == evaluated ? "--evaluate " : "", first.File(),
                  seen ? "only flights that the fit has not seen judge it" : "a flight counts once"));
}

// Counts for each part its rows that another one has too.
void CheckParts(const std::vector<Part>& parts, const FlightLog* evaluated,
                const std::vector<double>& zero_s) {
  const std::vector<Sample> samples = SamplesOf(parts, zero_s);
  std::vector<double> half_steps_s;
  half_steps_s.reserve(parts.size());
  for (const Part& part : parts) half_steps_s.push_back(HalfStepS(*part.flight));
  std::vector<std::size_t> shared(parts.size(), 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t p = samples[i].part;
    std::optional<std::size_t> other = OtherBeside(samples, i, -1, half_steps_s[p]);
    if (!other) other = OtherBeside(samples, i, 1, half_steps_s[p]);
    if (!other) continue;
    if (static_cast<double>(++shared[p]) > kSameShare * static_cast<double>(parts[p].flight->rows.size()))
      Refuse(parts[std::min(p, *other)], parts[std::max(p, *other)], evaluated);
  }
}

// How far the clocks of two parts are apart at numbers that each has once: of a copy it is the same at all of them,
// wherever it was cut.
std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> ClockDifferences(
    const std::vector<Sample>& samples) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> differences_s;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    std::map<std::size_t, std::vector<double>> times_s;  // by part
    for (; end < samples.size() && samples[end].power_w == samples[begin].power_w &&
           samples[end].airspeed_mps == samples[begin].airspeed_mps;
         ++end)
      times_s[samples[end].part].push_back(samples[end].time_s);
    std::erase_if(times_s, [](const auto& part) { return part.second.size() > 1; });
    if (times_s.empty()) continue;
    for (auto one = times_s.begin(), next = std::next(one); next != times_s.end(); one = next++)
      differences_s[{one->first, next->first}].push_back(next->second[0] - one->second[0]);
  }
  return differences_s;
}

// The middle of those that lie closest together, or none.
std::optional<double> CommonDifference(std::vector<double> differences_s, double width_s) {
  constexpr std::size_t kFewest = 3;
  std::sort(differences_s.begin(), differences_s.end());
  std::size_t most = 0, first = 0;
  for (std::size_t begin = 0, end = 0; begin < differences_s.size(); ++begin) {
    while (end < differences_s.size() && differences_s[end] - differences_s[begin] <= width_s) ++end;
    if (end - begin > most) most = end - begin, first = begin;
  }
  return most < kFewest ? std::nullopt : std::optional(differences_s[first + most / 2]);
}

}  // namespace

void CheckNoFlightTwice(const FlightLog& fitted, const FlightLog* evaluated) {
  std::vector<Part> parts;
  for (const Flight& flight : fitted.flights) parts.push_back({&fitted, &flight});
  if (evaluated != nullptr)
    for (const Flight& flight : evaluated->flights) parts.push_back({evaluated, &flight});
  const std::vector<double> as_recorded_s(parts.size(), 0.0);
  std::vector<double> first_rows_s;
  first_rows_s.reserve(parts.size());
  for (const Part& part : parts) first_rows_s.push_back(part.flight->rows.front().time_s);
  CheckParts(parts, evaluated, as_recorded_s);
  CheckParts(parts, evaluated, first_rows_s);
  for (const auto& [pair, differences_s] : ClockDifferences(SamplesOf(parts, as_recorded_s))) {
    const Part &one = parts[pair.first], &other = parts[pair.second];
    if (const auto apart_s = CommonDifference(differences_s, 2.0 * HalfStepS(*one.flight)))
      CheckParts({one, other}, evaluated, {0.0, *apart_s});
  }
}

}  // namespace ed3r::fit
