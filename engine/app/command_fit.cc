#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "engine/app/commands.h"
#include "engine/core/check.h"
#include "studies/fit/fit.h"
#include "studies/fit/report.h"

namespace ed3r {
namespace {

struct Options {
  FitOptions fit;
  std::vector<std::string> set;
  std::string out;
  bool json = false;
};

int Fit(Options options) {
  for (const std::string& setting : options.set) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos)
      throw UserError(fmt::format("--set {}: expected KEY=VALUE, e.g. robot.mass_kg=3.68", setting));
    options.fit.robot.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }
  const FitReport report = RunFit(options.fit);
  if (!options.out.empty()) WriteFitOutputs(report, options.out);
  if (options.json)
    fmt::print("{}\n", ToJson(report).dump(2));
  else
    PrintReport(report, std::cout);
  return kDone;
}

}  // namespace

Command AddFit(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* parser = program.add_subcommand(
      "fit", "Energy parameters fitted to flight logs: values, 95 % intervals, residuals");
  parser->add_option("LOG", options->fit.logs, "Flight logs (CSV)")->required();
  parser->add_option("--format", options->fit.format, "Columns: m100 | ardupilot | FILE.yaml; default m100");
  parser->add_option("--evaluate", options->fit.evaluate, "Logs that only judge the fit")
      ->allow_extra_args(false);
  parser->add_option("--evaluate-format", options->fit.evaluate_format,
                     "Their columns; default those of LOG");
  parser->add_option("--set", options->set, "robot.KEY=VALUE of the airframe that flew")
      ->allow_extra_args(false);
  parser->add_option("--out", options->out, "Folder for report, fitted.yaml, flights.csv and rows.csv");
  parser->add_flag("--json", options->json, "Print JSON");
  return {parser, [options] { return Fit(*options); }};
}

}  // namespace ed3r
