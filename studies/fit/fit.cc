#include "studies/fit/fit.h"

#include <fmt/format.h>

#include <chrono>

#include "engine/config/parameters.h"
#include "engine/core/check.h"

namespace ed3r {
namespace {

LogFormat FormatWithSettings(const std::string& name, const FitOptions& options) {
  LogFormat format = LoadLogFormat(name);
  Config config;
  config.robot = format.robot;
  for (const auto& [key, value] : options.robot) {
    const std::string problem = key.starts_with("robot.")
                                    ? SetParameter(config, key, value)
                                    : fmt::format("{}: ed3r fit takes robot.* keys only", key);
    if (!problem.empty()) throw UserError("--set: " + problem);
  }
  format.robot = config.robot;
  return format;
}

Rows AllRows(const std::vector<Flight>& flights) {
  Rows rows;
  for (const Flight& flight : flights)
    for (const FlightRow& row : flight.rows) rows.push_back(&row);
  return rows;
}

// Hover power of the fit in still air at the mass and density of each hovering row.
void AddStillAir(const EnergyModel& model, const FitReport& report, ModelReport& result) {
  Predictions still;
  for (const Flight& flight : report.groups) {
    std::vector<double>& powers = still.emplace_back();
    for (FlightRow row : flight.rows) {
      row.airspeed_mps = row.climb_mps = 0.0;
      powers.push_back(model.PowerW(row, result.estimate.values.data()));
    }
  }
  const std::vector<HoverPower> hover = Assess(report.groups, report.log.format, still).hover;
  for (std::size_t k = 0; k < hover.size(); ++k) result.held_out.hover[k].still_air_w = hover[k].predicted_w;
}

ModelReport FitModel(const EnergyModel& model, const FitReport& report) {
  ModelReport result;
  result.name = model.name();
  result.meaning = model.meaning();
  result.parameters = model.parameters();
  result.estimate = EstimateParameters(model, AllRows(report.groups));
  result.uncertainty = EstimateUncertainty(model, report.groups, result.estimate);
  result.held_out_w = CrossValidate(model, report.groups, result.estimate);
  result.held_out = Assess(report.groups, report.log.format, result.held_out_w);
  AddStillAir(model, report, result);
  return result;
}

}  // namespace

FitReport RunFit(const FitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  FitReport report;
  report.options = options;
  report.log = ReadFlightLog(options.logs, FormatWithSettings(options.format, options));
  if (!options.evaluate.empty()) {
    const std::string& name = options.evaluate_format.empty() ? options.format : options.evaluate_format;
    report.evaluate_log =
        ReadFlightLog(options.evaluate, FormatWithSettings(name, options), LogUse::kEvaluate);
  }
  report.segments = report.log.flights.size() < kMinGroups;
  report.groups = Groups(report.log);
  report.scaling = FitHoverScaling(report.log);
  for (const auto& model : MakeEnergyModels(report.log.format.robot, options.gravity_mps2))
    report.models.push_back(FitModel(*model, report));
  if (report.evaluate_log) {
    // The other log's airframe enters the formulas; only the parameters carry over.
    const auto models = MakeEnergyModels(report.evaluate_log->format.robot, options.gravity_mps2);
    for (std::size_t i = 0; i < models.size(); ++i)
      report.models[i].evaluated =
          Assess(report.evaluate_log->flights, report.evaluate_log->format,
                 Predict(*models[i], report.evaluate_log->flights, report.models[i].estimate.values));
  }
  for (std::size_t i = 1; i < report.models.size(); ++i)
    if (report.models[i].held_out.rms_residual_w < report.models[report.best].held_out.rms_residual_w)
      report.best = i;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

}  // namespace ed3r
