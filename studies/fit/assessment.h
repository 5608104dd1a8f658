// How well predicted powers agree with measured ones: energy per flight, hover power per mass, residuals over
// speed and climb rate. Drop-outs and spikes (RowQuality) count for none of it, on either side.
#pragma once

#include <vector>

#include "studies/fit/energy_model.h"
#include "studies/fit/estimate.h"

namespace ed3r::fit {

// Predicted power per flight and row.
using Predictions = std::vector<std::vector<double>>;

struct FlightEnergy {
  std::string id;
  double mass_kg = 0.0;
  double duration_s = 0.0;  // integrated: gaps above kMaxGapS and bad rows left out
  double measured_j = 0.0, predicted_j = 0.0;
  double ErrorPct() const { return 100.0 * (predicted_j / measured_j - 1.0); }
};

struct HoverPower {
  double mass_kg = 0.0;
  int rows = 0, flights = 0;
  double measured_w = 0.0, predicted_w = 0.0;  // means over the rows
  // The fit to all flights without any airspeed at the rows' mass and density: what a mission pays for
  // hovering. Real hover has wind, so this is an extrapolation of the fit. 0 where it is not known.
  double still_air_w = 0.0;
  double ErrorPct() const { return 100.0 * (predicted_w / measured_w - 1.0); }
};

struct ResidualBin {
  double low, high;  // of airspeed or climb rate, m/s
  int rows = 0;
  double mean_w = 0.0, deviation_w = 0.0;  // of measured - predicted
  double measured_w = 0.0, predicted_w = 0.0;
};

struct Assessment {
  std::vector<FlightEnergy> flights;
  double median_error_pct = 0.0;  // median over flights of |predicted / measured - 1|
  double p90_error_pct = 0.0, max_error_pct = 0.0;
  double mean_error_pct = 0.0;  // signed: bias
  double rms_residual_w = 0.0;
  std::vector<HoverPower> hover;  // by mass
  std::vector<ResidualBin> by_airspeed, by_climb;
};

// by_airspeed covers level rows only (|climb| <= kVerticalMps), by_climb all rows.
Assessment Assess(const std::vector<Flight>& flights, const LogFormat& format, const Predictions& predicted);

Predictions Predict(const EnergyModel& model, const std::vector<Flight>& flights,
                    const std::vector<double>& values);

// Every flight predicted by a fit that has not seen it: flight i belongs to fold i mod min(kFolds, flights).
// `full` is the fit to all flights: a fold's parameters start from it and are estimated from the fold's
// flights.
inline constexpr std::size_t kFolds = 10;
Predictions CrossValidate(const EnergyModel& model, const std::vector<Flight>& flights, const Estimate& full);

// The flights; or, where there are fewer than kMinGroups, each cut into segments of kSegmentS, which then
// stand for flights in intervals and cross-validation.
inline constexpr std::size_t kMinGroups = 5;
inline constexpr double kSegmentS = 10.0;
std::vector<Flight> Groups(const FlightLog& log);

// log(P_hover sqrt(rho)) = a + exponent log(m) over the flights that hover, errors robust to unequal
// variance. Theory: 1.5. exponent is NaN with fewer than three flights or a single mass.
struct HoverScaling {
  struct Point {
    double mass_kg, power_w;  // mean hover power, reduced to density kReferenceDensityKgm3
  };
  std::vector<Point> points;
  double exponent, low, high;
};
inline constexpr double kReferenceDensityKgm3 = 1.225;
HoverScaling FitHoverScaling(const FlightLog& log);

}  // namespace ed3r::fit
