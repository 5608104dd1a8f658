#include <cmath>

#include "studies/fit/fit_text.h"
#include "studies/metrics/number_text.h"

namespace ed3r::fit {
namespace {

using Json = nlohmann::ordered_json;

Json Pair(const Interval& interval) {
  return std::isnan(interval.low) ? Json(nullptr) : Json::array({interval.low, interval.high});
}

Json LogJson(const FlightLog& log) {
  std::vector<std::string> notes = log.notes;
  notes.insert(notes.end(), log.format.notes.begin(), log.format.notes.end());
  return {{"files", log.files},
          {"format", log.format.name},
          {"flights", log.flights.size()},
          {"rows", log.rows},
          {"hover_rows", log.hover_rows},
          {"rows_on_ground", log.rows_on_ground},
          {"short_flights", log.short_flights},
          {"drop_outs", log.drop_outs},
          {"spikes", log.spikes},
          {"climb_from", log.format.climb_from == ClimbFrom::kAltitude ? "altitude" : "column"},
          {"climb_drift_m", metrics::JsonNumber(log.climb_drift_m)},
          {"bad_rows", log.bad_rows},
          {"notes", notes}};
}

Json BinsJson(const std::vector<ResidualBin>& bins) {
  Json list = Json::array();
  for (const ResidualBin& bin : bins)
    list.push_back({{"low_mps", bin.low},
                    {"high_mps", bin.high},
                    {"rows", bin.rows},
                    {"residual_w", bin.mean_w},
                    {"deviation_w", bin.deviation_w},
                    {"measured_w", bin.measured_w},
                    {"predicted_w", bin.predicted_w}});
  return list;
}

Json AssessmentJson(const Assessment& assessment) {
  Json flights = Json::array(), hover = Json::array();
  for (const FlightEnergy& flight : assessment.flights)
    flights.push_back({{"id", flight.id},
                       {"mass_kg", flight.mass_kg},
                       {"duration_s", flight.duration_s},
                       {"measured_j", flight.measured_j},
                       {"predicted_j", flight.predicted_j},
                       {"error_pct", metrics::JsonNumber(flight.ErrorPct())}});
  for (const HoverPower& entry : assessment.hover)
    hover.push_back({{"mass_kg", entry.mass_kg},
                     {"rows", entry.rows},
                     {"flights", entry.flights},
                     {"measured_w", entry.measured_w},
                     {"predicted_w", entry.predicted_w},
                     {"still_air_w", entry.still_air_w > 0.0 ? Json(entry.still_air_w) : Json(nullptr)},
                     {"error_pct", metrics::JsonNumber(entry.ErrorPct())}});
  return {{"median_flight_energy_error_pct", assessment.median_error_pct},
          {"p90_flight_energy_error_pct", assessment.p90_error_pct},
          {"max_flight_energy_error_pct", assessment.max_error_pct},
          {"mean_flight_energy_error_pct", assessment.mean_error_pct},
          {"rms_residual_w", assessment.rms_residual_w},
          {"hover", hover},
          {"by_airspeed", BinsJson(assessment.by_airspeed)},
          {"by_climb", BinsJson(assessment.by_climb)},
          {"flights", flights}};
}

Json ParametersJson(const ModelReport& model) {
  Json parameters = Json::object();
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const ParameterSpec& spec = model.parameters[i];
    const Estimate& e = model.estimate;
    parameters[spec.name] = {{"value", e.values[i]},
                             {"unit", spec.unit},
                             {"key", spec.key},
                             {"ci95", Pair(model.uncertainty.flights[i])},
                             {"ci95_rows", Pair(model.uncertainty.rows[i])},
                             {"bounds", {spec.lower, spec.upper}},
                             {"flown", model.determination.values[i]},
                             {"not_determined", model.determination.not_determined[i].empty()
                                                    ? Json(nullptr)
                                                    : Json(model.determination.not_determined[i])},
                             {"at_bound", e.at_lower[i]   ? Json("lower")
                                          : e.at_upper[i] ? Json("upper")
                                                          : Json(nullptr)}};
  }
  return parameters;
}

Json ModelJson(const ModelReport& model) {
  const Estimate& e = model.estimate;
  Json correlation = Json::array();
  for (Eigen::Index r = 0; r < model.uncertainty.correlation.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < model.uncertainty.correlation.cols(); ++c)
      row.push_back(model.uncertainty.correlation(r, c));
    correlation.push_back(row);
  }
  const Assessment& judged = model.evaluated ? *model.evaluated : model.held_out;
  Json json = {
      {"median_flight_energy_error_pct", judged.median_error_pct},
      {"meaning", model.meaning},
      {"impossible", model.determination.Usable() ? Json(nullptr) : Json(model.determination.impossible)},
      {"parameters", ParametersJson(model)},
      {"correlation", correlation},
      {"loss", e.loss == Loss::kTukey ? "tukey" : "huber"},
      {"noise_w", e.scale_w},
      {"rows", e.rows},
      {"rows_beyond_low", e.beyond_low},
      {"rows_beyond_high", e.beyond_high},
      {"starts", e.starts},
      {"starts_agreeing", e.starts_agreeing},
      {"cross_validated", AssessmentJson(model.held_out)}};
  if (model.evaluated) json["evaluated"] = AssessmentJson(*model.evaluated);
  return json;
}

}  // namespace

Json ToJson(const FitReport& report) {
  Json models = Json::object(), points = Json::array();
  for (const ModelReport& model : report.models) models[model.name] = ModelJson(model);
  for (const HoverScaling::Point& point : report.scaling.points)
    points.push_back({{"mass_kg", point.mass_kg}, {"power_w", point.power_w}});
  Json json = {{"judged_on", report.evaluate_log ? "evaluate" : "cross-validation"},
               {"groups", report.segments ? "segments" : "flights"},
               {"best", report.models[report.best].name},
               {"models", models},
               {"log", LogJson(report.log)}};
  if (report.evaluate_log) json["evaluate_log"] = LogJson(*report.evaluate_log);
  json["hover_scaling"] = {{"exponent", metrics::JsonNumber(report.scaling.exponent)},
                           {"ci95", Pair({0.0, report.scaling.low, report.scaling.high})},
                           {"reference_density_kgm3", kReferenceDensityKgm3},
                           {"points", points}};
  return json;
}

}  // namespace ed3r::fit
