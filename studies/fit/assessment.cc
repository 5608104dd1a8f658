#include "studies/fit/assessment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/core/check.h"
#include "studies/fit/uncertainty.h"

namespace ed3r::fit {
namespace {

constexpr int kMinHoverRowsOfFlight = 5;

// Masses are told apart to 10 g.
long MassKey(double mass_kg) { return std::lround(100.0 * mass_kg); }

FlightEnergy Integrate(const Flight& flight, const std::vector<double>& predicted) {
  FlightEnergy energy{.id = flight.id, .mass_kg = flight.MassKg()};
  for (std::size_t i = 1; i < flight.rows.size(); ++i) {
    const FlightRow &a = flight.rows[i - 1], &b = flight.rows[i];
    const double dt = b.time_s - a.time_s;
    if (dt > kMaxGapS || a.quality != RowQuality::kGood || b.quality != RowQuality::kGood) continue;
    energy.duration_s += dt;
    energy.measured_j += 0.5 * dt * (a.power_w + b.power_w);
    energy.predicted_j += 0.5 * dt * (predicted[i - 1] + predicted[i]);
  }
  return energy;
}

double Quantile(std::vector<double> sorted, double share) {
  std::sort(sorted.begin(), sorted.end());
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

void SummariseFlights(Assessment& assessment) {
  std::vector<double> errors;
  for (const FlightEnergy& flight : assessment.flights) {
    if (flight.measured_j <= 0.0) continue;
    errors.push_back(std::abs(flight.ErrorPct()));
    assessment.mean_error_pct += flight.ErrorPct();
  }
  if (errors.empty()) return;
  assessment.mean_error_pct /= static_cast<double>(errors.size());
  assessment.median_error_pct = Quantile(errors, 0.5);
  assessment.p90_error_pct = Quantile(errors, 0.9);
  assessment.max_error_pct = Quantile(errors, 1.0);
}

// Running sums of one bin.
struct BinSums {
  int rows = 0;
  double residual = 0.0, square = 0.0, measured = 0.0, predicted = 0.0;

  void Add(double measured_w, double predicted_w) {
    const double r = measured_w - predicted_w;
    ++rows;
    residual += r;
    square += r * r;
    measured += measured_w;
    predicted += predicted_w;
  }
};

std::vector<ResidualBin> Bins(const std::map<int, BinSums>& sums, double width) {
  std::vector<ResidualBin> bins;
  for (const auto& [index, sum] : sums) {
    const double n = sum.rows, mean = sum.residual / n;
    bins.push_back({.low = index * width,
                    .high = (index + 1) * width,
                    .rows = sum.rows,
                    .mean_w = mean,
                    .deviation_w = std::sqrt(std::max(0.0, sum.square / n - mean * mean)),
                    .measured_w = sum.measured / n,
                    .predicted_w = sum.predicted / n});
  }
  return bins;
}

}  // namespace

Assessment Assess(const std::vector<Flight>& flights, const LogFormat& format, const Predictions& predicted) {
  constexpr double kAirspeedBin = 1.0, kClimbBin = 0.5;
  ED3R_CHECK(flights.size() == predicted.size(), "one prediction per flight");
  Assessment assessment;
  std::map<int, BinSums> by_airspeed, by_climb;
  std::map<long, HoverPower> hover;
  double square = 0.0, rows = 0.0;
  for (std::size_t f = 0; f < flights.size(); ++f) {
    assessment.flights.push_back(Integrate(flights[f], predicted[f]));
    std::map<long, bool> hovered;
    for (std::size_t i = 0; i < flights[f].rows.size(); ++i) {
      const FlightRow& row = flights[f].rows[i];
      if (row.quality != RowQuality::kGood) continue;
      const double p = predicted[f][i];
      square += (row.power_w - p) * (row.power_w - p);
      rows += 1.0;
      by_climb[static_cast<int>(std::floor(row.climb_mps / kClimbBin))].Add(row.power_w, p);
      if (std::abs(row.climb_mps) <= kVerticalMps)
        by_airspeed[static_cast<int>(std::floor(row.airspeed_mps / kAirspeedBin))].Add(row.power_w, p);
      if (!IsHover(row, format)) continue;
      HoverPower& entry = hover[MassKey(row.mass_kg)];
      entry.mass_kg = row.mass_kg;
      entry.flights += hovered.emplace(MassKey(row.mass_kg), true).second ? 1 : 0;
      ++entry.rows;
      entry.measured_w += row.power_w;
      entry.predicted_w += p;
    }
  }
  for (auto& [key, entry] : hover) {
    entry.measured_w /= entry.rows;
    entry.predicted_w /= entry.rows;
    assessment.hover.push_back(entry);
  }
  assessment.rms_residual_w = std::sqrt(square / std::max(1.0, rows));
  assessment.by_airspeed = Bins(by_airspeed, kAirspeedBin);
  assessment.by_climb = Bins(by_climb, kClimbBin);
  SummariseFlights(assessment);
  return assessment;
}

Predictions Predict(const EnergyModel& model, const std::vector<Flight>& flights,
                    const std::vector<double>& values) {
  Predictions predicted;
  for (const Flight& flight : flights) {
    std::vector<double>& powers = predicted.emplace_back();
    powers.reserve(flight.rows.size());
    for (const FlightRow& row : flight.rows) powers.push_back(model.PowerW(row, values.data()));
  }
  return predicted;
}

Predictions CrossValidate(const EnergyModel& model, const std::vector<Flight>& flights,
                          const Estimate& full) {
  ED3R_CHECK(flights.size() >= 2, "cross-validation needs two flights");
  const std::size_t folds = std::min(kFolds, flights.size());
  Predictions predicted(flights.size());
  for (std::size_t fold = 0; fold < folds; ++fold) {
    Rows rows;
    for (std::size_t f = 0; f < flights.size(); ++f)
      if (f % folds != fold)
        for (const FlightRow& row : flights[f].rows) rows.push_back(&row);
    const Estimate estimate = EstimateParameters(model, rows, full);
    for (std::size_t f = fold; f < flights.size(); f += folds)
      for (const FlightRow& row : flights[f].rows)
        predicted[f].push_back(model.PowerW(row, estimate.values.data()));
  }
  return predicted;
}

std::vector<Flight> Groups(const FlightLog& log) {
  if (log.flights.size() >= kMinGroups) return log.flights;
  std::vector<Flight> segments;
  for (const Flight& flight : log.flights) {
    const double begin_s = flight.rows.front().time_s;
    long current = -1;
    for (const FlightRow& row : flight.rows) {
      const long index = static_cast<long>((row.time_s - begin_s) / kSegmentS);
      if (index != current) segments.push_back({fmt::format("{}@{:g}s", flight.id, index * kSegmentS), {}});
      current = index;
      segments.back().rows.push_back(row);
    }
  }
  return segments;
}

HoverScaling FitHoverScaling(const FlightLog& log) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  HoverScaling scaling{.points = {}, .exponent = kNone, .low = kNone, .high = kNone};
  for (const Flight& flight : log.flights) {
    double sum = 0.0;
    int rows = 0;
    for (const FlightRow& row : flight.rows) {
      if (!IsHover(row, log.format)) continue;
      sum += row.power_w * std::sqrt(row.density_kgm3 / kReferenceDensityKgm3);
      ++rows;
    }
    if (rows >= kMinHoverRowsOfFlight && sum > 0.0) scaling.points.push_back({flight.MassKg(), sum / rows});
  }
  const double n = static_cast<double>(scaling.points.size());
  double mean_x = 0.0, mean_y = 0.0;
  for (const auto& point : scaling.points) {
    mean_x += std::log(point.mass_kg) / n;
    mean_y += std::log(point.power_w) / n;
  }
  double xx = 0.0, xy = 0.0;
  for (const auto& point : scaling.points) {
    const double x = std::log(point.mass_kg) - mean_x;
    xx += x * x;
    xy += x * (std::log(point.power_w) - mean_y);
  }
  if (n < 3.0 || xx < 1e-6) return scaling;
  scaling.exponent = xy / xx;
  double meat = 0.0;
  for (const auto& point : scaling.points) {
    const double x = std::log(point.mass_kg) - mean_x;
    const double r = std::log(point.power_w) - mean_y - scaling.exponent * x;
    meat += x * x * r * r;
  }
  const double error = std::sqrt(meat * n / (n - 2.0)) / xx;
  scaling.low = scaling.exponent - StudentT95(static_cast<int>(n) - 2) * error;
  scaling.high = scaling.exponent + StudentT95(static_cast<int>(n) - 2) * error;
  return scaling;
}

}  // namespace ed3r::fit
