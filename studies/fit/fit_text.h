// What a fit says: to a reader, to a script, and to a sweep.
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "studies/fit/fit.h"

namespace ed3r::fit {

// Tables: log, models with their error on held-out flights, parameters with intervals, hover power by mass.
void PrintReport(const FitReport& report, std::ostream& out);

// {"models": {"paper": {"median_flight_energy_error_pct": .., "parameters": {..}, ..}, ..}, ..}. The model's
// own median is over the flights of --evaluate where there are any, else over the cross-validated ones;
// "judged_on" says which. Not-a-number is null. Two runs on the same logs give the same JSON.
nlohmann::ordered_json ToJson(const FitReport& report);

// The airframe and every model's parameters as configuration keys (robot.*, energy.*), with the better model
// chosen as energy.model: what a sweep includes. Intervals stand in comments.
std::string FittedYaml(const FitReport& report);

inline constexpr const char* kFitOutputs[] = {"report.txt", "fit.json", "fitted.yaml", "flights.csv",
                                              "rows.csv"};

// Writes into the directory, making it: report.txt, fit.json, fitted.yaml, flights.csv (energy per flight)
// and rows.csv (every row with each model's held-out prediction); scripts/plot_fit.py draws from fit.json and
// rows.csv. Throws UserError where a file cannot be written.
void WriteFitOutputs(const FitReport& report, const std::string& directory);

}  // namespace ed3r::fit
