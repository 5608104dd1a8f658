#include "studies/fit/self_check.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>

#include "engine/config/environment.h"
#include "engine/core/check.h"
#include "engine/core/suggest.h"
#include "studies/fit/uncertainty.h"

namespace ed3r::fit {
namespace {

struct Plausible {
  const char* model;
  std::vector<double> values;
};

const std::vector<Plausible>& PlausibleModels() {
  static const std::vector<Plausible> models = {{"paper", {0.6, 0.9, 0.6}},
                                                {"paper-climb", {0.6, 0.9}},
                                                {"momentum-isolated", {0.75, 1.2, 0.5, 0.08}},
                                                {"momentum", {0.75, 1.2, 0.5, 0.08, 0.6}}};
  return models;
}

void Add(double truth, double value, const Interval& flights, const Interval& rows, ParameterCheck& check) {
  check.mean += value;
  check.deviation += (value - truth) * (value - truth);
  if (std::isnan(flights.low)) {
    ++check.without_interval;
    return;
  }
  check.mean_error += flights.standard_error;
  check.covered_flights += flights.low <= truth && truth <= flights.high ? 1 : 0;
  check.covered_rows += rows.low <= truth && truth <= rows.high ? 1 : 0;
}

}  // namespace

std::vector<double> PlausibleParameters(const std::string& model) {
  std::vector<std::string> names;
  for (const Plausible& plausible : PlausibleModels()) {
    if (plausible.model == model) return plausible.values;
    names.emplace_back(plausible.model);
  }
  const std::string nearest = NearestWord(model, names);
  throw UserError(fmt::format("self-check: unknown model '{}'{}", model,
                              nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

SelfCheckReport RunSelfCheck(const SelfCheckOptions& options) {
  SelfCheckReport report;
  report.options = options;
  if (report.options.truth.empty()) report.options.truth = PlausibleParameters(options.model);
  const std::vector<double>& truth = report.options.truth;
  const LogFormat format = LoadLogFormat("m100");
  const EnvironmentConfig environment;
  const auto models = MakeEnergyModels(format.robot, environment.gravity_mps2);
  const auto found = std::find_if(models.begin(), models.end(),
                                  [&](const auto& model) { return model->name() == options.model; });
  ED3R_CHECK(found != models.end(), options.model);
  const EnergyModel& model = **found;
  ED3R_CHECK(static_cast<int>(truth.size()) == model.size(), "one true value per parameter");
  for (std::size_t i = 0; i < truth.size(); ++i) {
    report.parameters.emplace_back();
    report.parameters[i].name = model.parameters()[i].name;
    report.parameters[i].truth = truth[i];
  }
  for (int k = 0; k < options.fits; ++k) {
    const FlightLog log =
        MakeSyntheticLog(model, truth, format, options.log, options.seed, static_cast<std::uint32_t>(k));
    Rows rows;
    for (const Flight& flight : log.flights)
      for (const FlightRow& row : flight.rows) rows.push_back(&row);
    const Estimate estimate = EstimateParameters(model, rows);
    const Uncertainty uncertainty = EstimateUncertainty(model, log.flights, estimate);
    for (std::size_t i = 0; i < truth.size(); ++i)
      Add(truth[i], estimate.values[i], uncertainty.flights[i], uncertainty.rows[i], report.parameters[i]);
  }
  for (ParameterCheck& check : report.parameters) {
    const double n = options.fits, bias = check.mean / n - check.truth;
    check.mean /= n;
    check.deviation = std::sqrt(std::max(0.0, check.deviation / n - bias * bias));
    check.mean_error /= std::max(1.0, n - check.without_interval);
  }
  return report;
}

void PrintSelfCheck(const SelfCheckReport& report, std::ostream& out) {
  const SyntheticOptions& log = report.options.log;
  fmt::print(out,
             "Self-check of '{}': {} synthetic logs of {} flights x {} rows, noise {:g} %, outliers {:g} %,\n"
             "correlation of neighbours {:g}, error common to a flight {:g} %\n",
             report.options.model, report.options.fits, log.flights, log.rows_per_flight,
             100 * log.noise_share, 100 * log.outlier_share, log.correlation, 100 * log.flight_share);
  fmt::print(out, "  {:<16} {:>8} {:>10} {:>9} {:>10} {:>11} {:>9} {:>6}\n", "", "truth", "mean", "deviation",
             "std. error", "by flights", "by rows", "none");
  for (std::size_t i = 0; i < report.parameters.size(); ++i) {
    const ParameterCheck& check = report.parameters[i];
    fmt::print(out, "  {:<16} {:>8.4g} {:>10.5g} {:>9.3g} {:>10.3g} {:>9.1f} % {:>7.1f} % {:>6}\n",
               check.name, check.truth, check.mean, check.deviation, check.mean_error,
               report.CoverageFlightsPct(i), report.CoverageRowsPct(i), check.without_interval);
  }
}

nlohmann::ordered_json ToJson(const SelfCheckReport& report) {
  const SyntheticOptions& log = report.options.log;
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < report.parameters.size(); ++i) {
    const ParameterCheck& check = report.parameters[i];
    parameters[check.name] = {{"truth", check.truth},
                              {"mean", check.mean},
                              {"deviation", check.deviation},
                              {"mean_standard_error", check.mean_error},
                              {"coverage_flights_pct", report.CoverageFlightsPct(i)},
                              {"coverage_rows_pct", report.CoverageRowsPct(i)},
                              {"without_interval", check.without_interval}};
  }
  return {{"model", report.options.model},
          {"fits", report.options.fits},
          {"flights", log.flights},
          {"rows_per_flight", log.rows_per_flight},
          {"noise_share", log.noise_share},
          {"outlier_share", log.outlier_share},
          {"drop_out_share", log.drop_out_share},
          {"correlation", log.correlation},
          {"flight_share", log.flight_share},
          {"seed", report.options.seed},
          {"parameters", parameters}};
}

}  // namespace ed3r::fit
