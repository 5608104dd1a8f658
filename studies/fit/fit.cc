#include "studies/fit/fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "studies/fit/power_check.h"
#include "studies/fit/repeated_flights.h"
#include "studies/fit/unit_check.h"
#include "studies/flight_logs/read_log.h"

namespace ed3r::fit {
namespace {

std::vector<flight_logs::LogTable> ReadTables(const std::vector<std::string>& paths,
                                              const flight_logs::LogReading& reading) {
  if (paths.empty()) throw UserError("ed3r fit: no log file given");
  std::vector<flight_logs::LogTable> tables;
  for (const std::string& path : paths) tables.push_back(flight_logs::ReadLog(path, reading));
  for (const flight_logs::LogTable& table : tables) {
    const bool one_source =
        table.kind() == flight_logs::LogKind::kCsv || table.kind() == flight_logs::LogKind::kAirData;
    if (reading.battery && one_source)
      throw UserError(
          fmt::format("--battery: is not allowed for '{}', whose columns are of one battery; allowed: for "
                      "PX4 and ArduPilot logs",
                      table.path()));
    if (table.kind() != tables.front().kind())
      throw UserError(fmt::format("{}: another kind of log than {}; fit logs of one kind at a time",
                                  table.path(), tables.front().path()));
  }
  return tables;
}

// The built-in format that a log has by its kind or, of CSV, by its columns.
std::string FormatOf(const flight_logs::LogTable& table) {
  switch (table.kind()) {
    case flight_logs::LogKind::kPx4:
      return "px4";
    case flight_logs::LogKind::kArduPilot:
      return "ardupilot";
    case flight_logs::LogKind::kAirData:
      return "dji";
    case flight_logs::LogKind::kCsv:
      break;
  }
  for (const char* name : {"m100", "ardupilot"}) {
    const LogFormat format = LoadLogFormat(name);
    if (std::all_of(format.columns.begin(), format.columns.end(),
                    [&](const auto& column) { return table.Has(column.second); }))
      return name;
  }
  throw UserError(
      fmt::format("{}:1:1: no built-in format has these columns: {}; say what they mean in a format file: "
                  "--format FILE.yaml (sweeps/OWN_DATA.md, \"A drone's log\")",
                  table.path(), fmt::join(table.columns(), ", ")));
}

// Mass and rotors decide what every number of the fit means: no default stands in for them.
constexpr const char* kAirframe[] = {"mass_kg", "propellers", "propeller_radius_m"};

bool NamesAirframe(const FitOptions& options) {
  return std::all_of(std::begin(kAirframe), std::end(kAirframe), [&](const std::string& key) {
    return std::any_of(options.robot.begin(), options.robot.end(),
                       [&](const auto& setting) { return setting.first == "robot." + key; });
  });
}

void CheckAirframe(const LogFormat& format, const std::string& path) {
  std::vector<std::string> missing;
  for (const std::string key : kAirframe)
    if (!format.robot_keys.contains(key) && !(key == "mass_kg" && format.Has("mass_kg")))
      missing.push_back("robot." + key);
  if (missing.empty()) return;
  throw UserError(fmt::format(
      "{}: the airframe that flew is not known: {} {} needed, for instance --set robot.mass_kg=1.4 --set "
      "robot.propellers=4 --set robot.propeller_radius_m=0.12, or 'robot:' in the format file",
      path, fmt::join(missing, ", "), missing.size() == 1 ? "is" : "are"));
}

LogFormat FormatWithSettings(const flight_logs::LogTable& table, const std::string& chosen,
                             const FitOptions& options) {
  const std::string name = chosen.empty() ? FormatOf(table) : chosen;
  LogFormat format = LoadLogFormat(name);
  // What a built-in format says of an airframe is that of its own data set, never that of a raw log.
  if (table.kind() != flight_logs::LogKind::kCsv && IsBuiltInLogFormat(name)) {
    format.robot = {};
    format.robot_keys.clear();
    format.notes.clear();
    if (table.Has("air_density_kgm3")) format.columns["air_density_kgm3"] = "air_density_kgm3";
    if (!table.Has("throttle_0_1000")) format.in_flight.erase("throttle_0_1000");
  }
  // Nor do its notes on that airframe tell of one that was named.
  if (IsBuiltInLogFormat(name) && NamesAirframe(options))
    std::erase_if(format.notes, [](const std::string& note) { return note.find("airframe") != note.npos; });
  Config config;
  config.robot = format.robot;
  for (const auto& [key, value] : options.robot) {
    const std::string problem = key.starts_with("robot.")
                                    ? SetParameter(config, key, value)
                                    : fmt::format("{}: ed3r fit takes robot.* keys only", key);
    if (!problem.empty()) throw UserError("--set: " + problem);
    format.robot_keys.insert(key.substr(std::string("robot.").size()));
  }
  format.robot = config.robot;
  CheckAirframe(format, table.path());
  return format;
}

FlightLog LoadLog(const std::vector<std::string>& paths, const std::string& format, const FitOptions& options,
                  LogUse use) {
  std::vector<flight_logs::LogTable> tables = ReadTables(paths, options.reading);
  const LogFormat with_settings = FormatWithSettings(tables.front(), format, options);
  for (flight_logs::LogTable& table : tables)
    table.DecimalCommasToPoints(NumberColumns(table, with_settings));
  FlightLog log = MakeFlightLog(tables, with_settings, use, options.reading);
  CheckMeasuredPower(tables, log, options.gravity_mps2);
  return log;
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

// What a sweep flies where a fit writes nothing.
std::vector<double> DefaultsOf(const EnergyModel& model, const RobotConfig& robot) {
  Config config;
  config.robot = robot;
  std::vector<double> defaults;
  for (const ParameterSpec& spec : model.parameters())
    defaults.push_back(std::stod(GetParameter(config, spec.key)));
  return defaults;
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
  result.determination = Determine(model, DefaultsOf(model, report.log.format.robot), report.groups,
                                   result.estimate, result.uncertainty, result.held_out);
  return result;
}

// The model with the smallest residuals among those that may be flown.
std::size_t BestOf(const FitReport& report) {
  std::optional<std::size_t> best;
  std::vector<std::string> why;
  bool flown = false;  // the engine does not fly momentum-isolated
  for (std::size_t i = 0; i < report.models.size(); ++i) {
    const ModelReport& model = report.models[i];
    if (!model.determination.Usable()) {
      why.push_back(fmt::format("{} ({})", model.name, model.determination.impossible));
      continue;
    }
    flown = flown || model.name != "momentum-isolated";
    if (!best || model.held_out.rms_residual_w < report.models[*best].held_out.rms_residual_w) best = i;
  }
  if (!flown)
    throw UserError(
        fmt::format("{}: no model explains this log: {}; check robot.mass_kg, robot.propellers, "
                    "robot.propeller_radius_m and the log's units",
                    report.log.files.front(), fmt::join(why, ", ")));
  return *best;
}

}  // namespace

FitReport RunFit(const FitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  FitReport report;
  report.options = options;
  report.log = LoadLog(options.logs, options.format, options, LogUse::kFit);
  if (!options.evaluate.empty()) {
    const std::string& name = options.evaluate_format.empty() ? options.format : options.evaluate_format;
    report.evaluate_log = LoadLog(options.evaluate, name, options, LogUse::kEvaluate);
  }
  CheckNoFlightTwice(report.log, report.evaluate_log ? &*report.evaluate_log : nullptr);
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
  report.best = BestOf(report);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

}  // namespace ed3r::fit
