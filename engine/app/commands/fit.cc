#include "studies/fit/fit.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "engine/app/commands.h"
#include "engine/app/perception_looks.h"
#include "engine/app/settings.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/message.h"
#include "engine/store/directory_lock.h"
#include "studies/figures/draw.h"
#include "studies/fit/fit_text.h"
#include "studies/fit/self_check.h"

namespace ed3r::app {
namespace {

struct Options {
  fit::FitOptions fit;
  fit::SelfCheckOptions self_check{.model = "momentum", .truth = {}, .fits = 0, .log = {}};
  std::string perception;  // run directory
  std::vector<std::string> set;
  std::string battery;
  std::string out;
  bool json = false;
  bool no_figures = false;
};

int SelfCheck(const Options& options) {
  const fit::SelfCheckReport report = fit::RunSelfCheck(options.self_check);
  if (options.json)
    fmt::print("{}\n", fit::ToJson(report).dump(2));
  else
    fit::PrintSelfCheck(report, std::cout);
  return kDone;
}

int FitPerception(const Options& options) {
  const PerceptionLooks found = LooksOfRun(options.perception);
  const perception_fit::ProfileFit fit = perception_fit::FitProfile(found.looks, found.configured);
  if (!options.out.empty()) {
    const std::filesystem::path folder(options.out);
    MakeFolder(folder);
    const auto alone = store::LockToWrite(folder.string());
    FileSet files;
    files.Add(folder / "perception.yaml", perception_fit::ProfileFitYaml(fit, options.perception));
    files.Add(folder / "perception.json", perception_fit::ProfileFitJson(fit).dump(2) + "\n");
    files.Add(folder / "looks.csv", perception_fit::LooksCsv(found.looks, fit));
    files.Commit();
  }
  fmt::print("{}\n", options.json ? perception_fit::ProfileFitJson(fit).dump(2)
                                  : perception_fit::ProfileFitText(fit));
  return kDone;
}

int BatteryOf(const std::string& text) {
  if (text == "all") return flight_logs::kAllBatteries;
  int number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || stop != text.data() + text.size() || number < 0 || number > 255)
    throw UserError(
        OneLine(fmt::format("--battery {}: expected all, or a number of a battery, 0 .. 255", text)));
  return number;
}

int Fit(Options options) {
  if (!options.perception.empty()) return FitPerception(options);
  if (options.self_check.fits > 0) return SelfCheck(options);
  if (options.fit.logs.empty())
    throw UserError("fit: a flight log is needed, e.g. sweeps/data/flight/m100_flights.csv");
  for (const std::string& setting : options.set) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos)
      throw UserError(fmt::format("--set {}: expected KEY=VALUE, e.g. robot.mass_kg=3.68", setting));
    options.fit.robot.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }
  CheckSetOnce(options.set);
  if (!options.battery.empty()) options.fit.reading.battery = BatteryOf(options.battery);
  std::vector<std::string> inputs = options.fit.logs;
  inputs.insert(inputs.end(), options.fit.evaluate.begin(), options.fit.evaluate.end());
  inputs.insert(inputs.end(), {options.fit.format, options.fit.evaluate_format});
  if (!options.out.empty())
    for (const char* output : fit::kFitOutputs)
      CheckNoInput(std::filesystem::path(options.out) / output, inputs, "--out");
  const fit::FitReport report = fit::RunFit(options.fit);
  figures::DrawResult drawn;
  if (!options.out.empty()) {
    MakeFolder(options.out);
    const auto alone = store::LockToWrite(options.out);
    fit::WriteFitOutputs(report, options.out);
    if (!options.no_figures) drawn = figures::DrawFigures(options.out, "plot_fit.py");
  }
  if (options.json)
    fmt::print("{}\n", fit::ToJson(report).dump(2));
  else
    fit::PrintReport(report, std::cout);
  if (drawn.outcome != figures::Drawing::kDone) Tell("no figures: {}", drawn.message);
  return drawn.outcome == figures::Drawing::kFailed ? kFailedInside : kDone;
}

}  // namespace

Command AddFit(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser =
      program.AddCommand("fit", "Energy parameters fitted to flight logs: values, 95 % intervals, residuals");
  parser.Option("LOG", options->fit.logs,
                "Flight logs, told by content: PX4 .ulg, ArduPilot .bin, AirData (DJI) CSV, CSV");
  parser.Option("--format", options->fit.format,
                "Columns: m100 | ardupilot | px4 | dji | FILE.yaml; default by content");
  parser.Option("--evaluate", options->fit.evaluate, "Logs that only judge the fit").OneValue();
  parser.Option("--evaluate-format", options->fit.evaluate_format, "Their columns; default those of LOG")
      .Needs("--evaluate");
  parser.Flag("--skip-bad", options->fit.reading.skip_bad,
              "Leave out and count rows or messages that cannot be read (at most 10 %)");
  parser.Option("--battery", options->battery,
                "Of a raw log with several: NUMBER | all (sum of their powers)");
  parser.Option("--set", options->set, "robot.KEY=VALUE of the airframe that flew").OneValue();
  parser.Option("--out", options->out,
                "Folder for report, fitted.yaml, flights.csv and rows.csv; with --perception for "
                "perception.yaml, perception.json, looks.csv");
  parser.Flag("--no-figures", options->no_figures, "With --out: draw nothing (no Python)");
  const std::vector<std::string> of_logs = {"LOG",        "--format",  "--evaluate", "--evaluate-format",
                                            "--skip-bad", "--battery", "--set",      "--no-figures"};
  parser
      .Option("--perception", options->perception,
              "Instead of LOG: fit the fast perception tier to a run of the pixel tier (run directory)")
      .Excludes(of_logs);
  parser
      .Option("--self-check", options->self_check.fits,
              "Instead of LOG: fit this many synthetic logs and say how often the intervals hold the truth")
      .Range(1, 1000000)
      .Excludes(of_logs)
      .Excludes({"--out", "--perception"});
  parser.Option("--model", options->self_check.model, "Model of the synthetic logs; default momentum")
      .Needs("--self-check");
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] { return Fit(*options); }};
}

}  // namespace ed3r::app
