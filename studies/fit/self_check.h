// Does the estimation tell the truth where the truth is known? Many synthetic logs, each fitted by the whole
// procedure (several starts, both loss stages); how often the 95 % intervals hold the parameters that made
// the logs.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "studies/fit/synthetic.h"

namespace ed3r::fit {

struct SelfCheckOptions {
  std::string model = "momentum";
  std::vector<double> truth = {};  // empty: PlausibleParameters(model)
  int fits = 1000;
  SyntheticOptions log;
  std::uint64_t seed = 1;
};

struct ParameterCheck {
  std::string name;
  double truth = 0.0;
  double mean = 0.0, deviation = 0.0;  // of the estimates
  double mean_error = 0.0;             // mean standard error by flights
  int covered_flights = 0, covered_rows = 0;
  int without_interval = 0;  // at a bound or undetermined: counted as not covered
};

struct SelfCheckReport {
  SelfCheckOptions options;
  std::vector<ParameterCheck> parameters;
  double CoverageFlightsPct(std::size_t i) const {
    return 100.0 * parameters[i].covered_flights / options.fits;
  }
  double CoverageRowsPct(std::size_t i) const { return 100.0 * parameters[i].covered_rows / options.fits; }
};

// Values inside the bounds of the model's parameters, near those of a Matrice 100. Throws UserError for an
// unknown model.
std::vector<double> PlausibleParameters(const std::string& model);

// Deterministic in its options. About 40 ms per fit of 6,000 rows.
SelfCheckReport RunSelfCheck(const SelfCheckOptions& options);

void PrintSelfCheck(const SelfCheckReport& report, std::ostream& out);
nlohmann::ordered_json ToJson(const SelfCheckReport& report);

}  // namespace ed3r::fit
