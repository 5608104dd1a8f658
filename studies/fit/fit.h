// `ed3r fit`: energy parameters of a user's own airframe from its flight logs.
//
// Models are fitted to all flights of the logs and judged on flights that their fit has not seen: by
// cross-validation over flights, and on further logs where given. Deterministic, one thread; about 4 s for
// 37,000 rows.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/fit/assessment.h"
#include "studies/fit/determination.h"
#include "studies/fit/uncertainty.h"

namespace ed3r::fit {

struct FitOptions {
  std::vector<std::string> logs = {};
  std::string format = {};  // LoadLogFormat: built-in name or YAML file; "" = by the log's content
  std::vector<std::string> evaluate = {};
  std::string evaluate_format = {};  // "" = format
  // robot.* keys over those of the format, e.g. {"robot.mass_kg", "1.3"}: the airframe that flew. Other keys
  // throw.
  std::vector<std::pair<std::string, std::string>> robot = {};
  double gravity_mps2 = 9.8;
  flight_logs::LogReading reading = {};
};

struct ModelReport {
  std::string name, meaning;
  std::vector<ParameterSpec> parameters;
  Estimate estimate;
  Uncertainty uncertainty;
  Assessment held_out;                  // each flight by a fit without it
  std::optional<Assessment> evaluated;  // flights of FitOptions::evaluate, by the fit to all of `logs`
  Predictions held_out_w;               // per group and row
  Determination determination;          // what of it may be flown
};

struct FitReport {
  FitOptions options;
  FlightLog log;
  std::vector<Flight> groups;  // units of intervals and folds: flights, or segments of few flights
  bool segments = false;
  std::optional<FlightLog> evaluate_log;
  std::vector<ModelReport> models;
  // Smallest rms residual of held-out rows among the models that may be flown (Determination::Usable). Not the energy per flight: there, errors in hover and cruise
  // cancel.
  std::size_t best = 0;
  HoverScaling scaling;
  double seconds = 0.0;  // wall time of the fit, reading included; not in the JSON's results
};

// Throws UserError for bad input: log, format, key, an airframe without mass or propellers, a flight given twice, units that cannot be, power
// that was not measured, a log that no model explains.
FitReport RunFit(const FitOptions& options);

}  // namespace ed3r::fit
