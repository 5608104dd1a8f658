#include "studies/fit/fit_text.h"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "engine/core/check.h"
#include "engine/core/files/end_mark.h"
#include "engine/core/files/file.h"
#include "engine/core/files/remove_file.h"

namespace ed3r::fit {
namespace {

const char* UnitsOf(const FitReport& report) { return report.segments ? "segments" : "flights"; }

const char* BoundOf(const Estimate& estimate, std::size_t i) {
  return estimate.at_lower[i] ? "lower" : estimate.at_upper[i] ? "upper" : "";
}

std::string IntervalText(const Interval& interval) {
  return std::isnan(interval.low) ? "-" : fmt::format("{:.4g} .. {:.4g}", interval.low, interval.high);
}

void PrintLog(const FitReport& report, std::ostream& out) {
  const FlightLog& log = report.log;
  fmt::print(out, "Log       {} ({})\n", fmt::join(log.files, ", "), log.format.name);
  fmt::print(out, "          {} flights, {} rows in flight, {} hovering; {} drop-outs, {} spikes\n",
             log.flights.size(), log.rows, log.hover_rows, log.drop_outs, log.spikes);
  if (log.rows_on_ground > 0)
    fmt::print(out, "          {} rows on the ground left out\n", log.rows_on_ground);
  if (log.short_flights > 0)
    fmt::print(out, "          {} flights of fewer than {} rows left out\n", log.short_flights,
               kMinFlightRows);
  if (!std::isnan(log.climb_drift_m))
    fmt::print(
        out, "          recorded climb rate and altitude part by {:.1f} m a flight on average; {} is used\n",
        log.climb_drift_m, log.format.climb_from == ClimbFrom::kAltitude ? "altitude" : "the climb rate");
  if (log.bad_rows > 0)
    fmt::print(out, "          {} rows or messages that could not be read left out (--skip-bad){}\n",
               log.bad_rows, log.first_bad.empty() ? "" : "; the first: " + log.first_bad);
  for (const std::string& note : log.notes) fmt::print(out, "          note: {}\n", note);
  for (const std::string& note : log.format.notes) fmt::print(out, "          note: {}\n", note);
  if (report.segments)
    fmt::print(out, "          fewer than {} flights: segments of {:g} s stand for flights\n", kMinGroups,
               kSegmentS);
}

void PrintErrors(const FitReport& report, std::ostream& out, bool evaluated) {
  if (evaluated)
    fmt::print(out, "\nEnergy per flight of {}, never seen by the fit ({} flights)\n",
               fmt::join(report.evaluate_log->files, ", "), report.evaluate_log->flights.size());
  else
    fmt::print(out, "\nEnergy of held-out {} ({} folds)\n", UnitsOf(report),
               std::min(kFolds, report.groups.size()));
  fmt::print(out, "  {:<18} {:>9} {:>9} {:>9} {:>9} {:>11}\n", "model", "median %", "p90 %", "max %",
             "bias %", "row rms W");
  for (const ModelReport& model : report.models) {
    const Assessment& a = evaluated ? *model.evaluated : model.held_out;
    fmt::print(out, "  {:<18} {:>9.2f} {:>9.2f} {:>9.2f} {:>+9.2f} {:>11.1f}{}\n", model.name,
               a.median_error_pct, a.p90_error_pct, a.max_error_pct, a.mean_error_pct, a.rms_residual_w,
               !evaluated && &model == &report.models[report.best] ? "  <- smallest" : "");
  }
}

// What a sweep may not take from this model.
void PrintDetermination(const ModelReport& model, std::ostream& out) {
  const Determination& d = model.determination;
  if (!d.Usable()) fmt::print(out, "  IMPOSSIBLE, none of it is written: {}\n", d.impossible);
  if (!d.Usable()) return;
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (!d.not_determined[i].empty())
      fmt::print(out, "  {} is not written: {}; the others are fitted again with its default {:g}\n",
                 model.parameters[i].name, d.not_determined[i], d.values[i]);
}

void PrintParameters(const FitReport& report, std::ostream& out) {
  fmt::print(out, "\nParameters, 95 % intervals\n  {:<16} {:>10}  {:<22} {:<22} {}\n", "", "value",
             report.segments ? "by segments" : "by flights", "as if rows independent", "bounds");
  for (const ModelReport& model : report.models) {
    const Estimate& e = model.estimate;
    fmt::print(out, "  {}: {}; {} loss, noise {:.1f} W, {} + {} rows beyond, {} of {} starts agree\n",
               model.name, model.meaning, e.loss == Loss::kTukey ? "Tukey" : "Huber", e.scale_w, e.beyond_low,
               e.beyond_high, e.starts_agreeing, e.starts);
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      const ParameterSpec& spec = model.parameters[i];
      const std::string bound = BoundOf(e, i);
      fmt::print(out, "  {:<16} {:>10.4g}  {:<22} {:<22} {:g} .. {:g}{}{}\n", spec.name, e.values[i],
                 IntervalText(model.uncertainty.flights[i]), IntervalText(model.uncertainty.rows[i]),
                 spec.lower, spec.upper, spec.unit.empty() ? "" : " " + spec.unit,
                 bound.empty() ? "" : fmt::format("  AT ITS {} BOUND", bound == "lower" ? "LOWER" : "UPPER"));
    }
    if (!model.uncertainty.determined) fmt::print(out, "  (the data do not determine the free parameters)\n");
    PrintDetermination(model, out);
  }
  fmt::print(out,
             "  Intervals by {}: any correlation within one is allowed for (wind, gusts, battery); they "
             "claim what would\n"
             "  happen with other {} like these, not that the model is right.\n",
             UnitsOf(report), UnitsOf(report));
}

void PrintHover(const FitReport& report, std::ostream& out) {
  fmt::print(out,
             "\nHover power: error on held-out {}, and power of the fit in still air\n  {:>8} {:>6} {:>11}",
             UnitsOf(report), "mass kg", "rows", "measured W");
  for (const ModelReport& model : report.models) fmt::print(out, " {:>18}", model.name);
  fmt::print(out, "\n");
  for (std::size_t k = 0; k < report.models.front().held_out.hover.size(); ++k) {
    const HoverPower& hover = report.models.front().held_out.hover[k];
    fmt::print(out, "  {:>8.2f} {:>6} {:>11.1f}", hover.mass_kg, hover.rows, hover.measured_w);
    for (const ModelReport& model : report.models) {
      const HoverPower& of_model = model.held_out.hover[k];
      fmt::print(out, " {:>+8.2f} % {:>5.0f} W", of_model.ErrorPct(), of_model.still_air_w);
    }
    fmt::print(out, "\n");
  }
  if (!std::isnan(report.scaling.exponent))
    fmt::print(out, "  P_hover ~ m^{:.2f} (95 % {:.2f} .. {:.2f}, {} flights; theory 1.5)\n",
               report.scaling.exponent, report.scaling.low, report.scaling.high,
               report.scaling.points.size());
}

std::string FlightsCsv(const FitReport& report) {
  std::string csv = "set,flight,mass_kg,duration_s,measured_j";
  for (const ModelReport& model : report.models) csv += "," + model.name + "_j";
  csv += "\n";
  for (const bool evaluated : {false, true}) {
    if (evaluated && !report.evaluate_log) break;
    const auto flights = [&](const ModelReport& m) -> const std::vector<FlightEnergy>& {
      return evaluated ? m.evaluated->flights : m.held_out.flights;
    };
    for (std::size_t f = 0; f < flights(report.models.front()).size(); ++f) {
      const FlightEnergy& first = flights(report.models.front())[f];
      csv += fmt::format("{},{},{:g},{:.2f},{:.1f}", evaluated ? "evaluated" : "held-out", first.id,
                         first.mass_kg, first.duration_s, first.measured_j);
      for (const ModelReport& model : report.models)
        csv += fmt::format(",{:.1f}", flights(model)[f].predicted_j);
      csv += "\n";
    }
  }
  return csv;
}

std::string RowsCsv(const FitReport& report) {
  std::string csv = "flight,time_s,airspeed_mps,climb_mps,mass_kg,density_kgm3,power_w,good";
  for (const ModelReport& model : report.models) csv += "," + model.name + "_w";
  csv += "\n";
  auto out = std::back_inserter(csv);
  for (std::size_t f = 0; f < report.groups.size(); ++f) {
    for (std::size_t i = 0; i < report.groups[f].rows.size(); ++i) {
      const FlightRow& row = report.groups[f].rows[i];
      fmt::format_to(out, "{},{:.2f},{:.2f},{:.3f},{:g},{:g},{:.2f},{}", report.groups[f].id, row.time_s,
                     row.airspeed_mps, row.climb_mps, row.mass_kg, row.density_kgm3, row.power_w,
                     row.quality == RowQuality::kGood ? 1 : 0);
      for (const ModelReport& model : report.models) fmt::format_to(out, ",{:.1f}", model.held_out_w[f][i]);
      csv += "\n";
    }
  }
  return csv;
}

}  // namespace

void PrintReport(const FitReport& report, std::ostream& out) {
  PrintLog(report, out);
  PrintErrors(report, out, false);
  if (report.evaluate_log) PrintErrors(report, out, true);
  PrintParameters(report, out);
  PrintHover(report, out);
}

namespace {

std::string YamlEntryOf(const std::string& key, double value, const std::string& comment) {
  return fmt::format("  {}: {:.6g}{}\n", key, value, comment.empty() ? "" : "  # " + comment);
}

// What was named of the airframe; what was not stays the engine's default and says so.
std::string AirframeText(const FitReport& report) {
  const LogFormat& format = report.log.format;
  const RobotConfig& robot = format.robot;
  const double mass_kg =
      format.robot_keys.contains("mass_kg") ? robot.mass_kg : report.log.flights.front().MassKg();
  std::string text = YamlEntryOf("mass_kg", mass_kg, "without payload") +
                     YamlEntryOf("propellers", robot.propellers, "") +
                     YamlEntryOf("propeller_radius_m", robot.propeller_radius_m, "");
  for (const auto& [key, value] : {std::pair<const char*, double>{"height_m", robot.height_m},
                                   {"width_m", robot.width_m},
                                   {"depth_m", robot.depth_m},
                                   {"battery_mah", robot.battery_mah},
                                   {"battery_v", robot.battery_v}})
    text += format.robot_keys.contains(key)
                ? YamlEntryOf(key, value, "")
                : fmt::format("  # {}: {:.6g} is the engine's default; yours was not named\n", key, value);
  return text;
}

// The keys of a model that the data determine; the others as comments, with the default that stands for them.
void AppendParameters(const ModelReport& model, std::string& robot_text, std::string& energy_text) {
  const Determination& d = model.determination;
  if (!d.Usable()) {
    energy_text += fmt::format("  # {}: nothing written, {}\n", model.name, d.impossible);
    return;
  }
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const std::string& key = model.parameters[i].key;
    const std::string name = key.substr(key.find('.') + 1);
    std::string& text = key.starts_with("robot.") ? robot_text : energy_text;
    const Interval& interval = d.intervals[i];
    if (!d.not_determined[i].empty())
      text += fmt::format("  # {}: {}, not determined: {}; its default {:g} was held\n", name, model.name,
                          d.not_determined[i], d.values[i]);
    else
      text += YamlEntryOf(
          name, d.values[i],
          fmt::format("{}, {}", model.name,
                      std::isnan(interval.low) ? "at its lower bound" : "95 %: " + IntervalText(interval)));
  }
}

const ModelReport& ModelOf(const FitReport& report, const std::string& name) {
  const auto found = std::find_if(report.models.begin(), report.models.end(),
                                  [&](const ModelReport& model) { return model.name == name; });
  ED3R_CHECK(found != report.models.end(), name);
  return *found;
}

// The paper's model as printed, unless its climb form is the best of all or the only one of the two that may be flown.
std::string PaperFormOf(const FitReport& report) {
  const bool printed = ModelOf(report, "paper").determination.Usable();
  const bool climb = ModelOf(report, "paper-climb").determination.Usable();
  return report.models[report.best].name == "paper-climb" || (climb && !printed) ? "paper-climb" : "paper";
}

// What the engine flies: the paper's model or the momentum model with interference; of those that may be flown, the one
// with the smaller residuals.
bool FliesPaper(const FitReport& report, const std::string& paper_form) {
  const ModelReport &paper = ModelOf(report, paper_form), &momentum = ModelOf(report, "momentum");
  if (!momentum.determination.Usable()) return true;
  return paper.determination.Usable() && paper.held_out.rms_residual_w < momentum.held_out.rms_residual_w;
}

}  // namespace

std::string FittedYaml(const FitReport& report) {
  std::string text =
      fmt::format("# Airframe and energy parameters fitted to {} ({} flights, {} rows) by 'ed3r fit'.\n",
                  fmt::join(report.log.files, ", "), report.log.flights.size(), report.log.rows);
  text += fmt::format("# Median energy error per held-out {}:", report.segments ? "segment" : "flight");
  for (const ModelReport& model : report.models)
    text += fmt::format(" {} {:.2f} %{}", model.name, model.held_out.median_error_pct,
                        &model == &report.models.back() ? ".\n" : ",");
  text += fmt::format("{}\n", kEndAnnounced);
  std::string robot_text, energy_text;
  const std::string paper_name = PaperFormOf(report);
  for (const ModelReport& model : report.models)
    if (model.name == paper_name || model.name == "momentum")
      AppendParameters(model, robot_text, energy_text);
  text += "robot:\n" + AirframeText(report) + robot_text;
  return text +
         fmt::format("energy:\n  model: {}\n{}{}{}\n", FliesPaper(report, paper_name) ? "paper" : "momentum",
                     paper_name == "paper-climb" ? "  vertical_form: climb\n" : "", energy_text, kEndMark);
}

void WriteFitOutputs(const FitReport& report, const std::string& directory) {
  MakeFolder(directory);
  const std::filesystem::path path(directory);
  // Of another fit, they would be taken for pictures of this one.
  for (const char* picture : {"fit_residuals", "fit_energy", "fit_hover"})
    for (const char* ending : {".png", ".svg"}) RemoveFile(path / fmt::format("{}{}", picture, ending));
  // The report comes last: where it is, all is of its fit.
  for (const char* name : {"report.txt", "plot.log"}) RemoveFile(path / name);
  std::ostringstream text;
  PrintReport(report, text);
  FileSet files;
  files.Add(path / "fit.json", ToJson(report).dump(1) + "\n");
  files.Add(path / "fitted.yaml", FittedYaml(report));
  files.Add(path / "flights.csv", FlightsCsv(report));
  files.Add(path / "rows.csv", RowsCsv(report));
  files.Add(path / "report.txt", text.str());
  files.Commit();
}

}  // namespace ed3r::fit
