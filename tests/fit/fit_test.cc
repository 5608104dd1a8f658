// The whole fit on the two real logs.
#include "studies/fit/fit.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/yaml_reader.h"
#include "studies/fit/fit_text.h"

namespace ed3r::fit {
namespace {

const std::string kFlights = std::string(ED3R_SOURCE_DIR) + "/sweeps/data/flight/";

// Rows of the flights for which keep(flight) holds, in a file of its own.
template <class Keep>
std::string Extract(const std::string& name, Keep keep) {
  const std::string path = ::testing::TempDir() + name;
  std::ifstream in(kFlights + "m100_flights.csv");
  std::ofstream out(path);
  std::string line;
  std::getline(in, line);
  out << line << "\n";
  while (std::getline(in, line))
    if (keep(std::stoi(line))) out << line << "\n";
  return path;
}

class M100Test : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { report_ = new FitReport(RunFit({.logs = {kFlights + "m100_flights.csv"}})); }
  static void TearDownTestSuite() { delete report_; }

  static const ModelReport& Model(const std::string& name) {
    for (const ModelReport& model : report_->models)
      if (model.name == name) return model;
    throw InternalError(name);
  }

  static const FitReport* report_;
};
const FitReport* M100Test::report_ = nullptr;

TEST_F(M100Test, ReadsTheLogAsShipped) {
  EXPECT_EQ(report_->log.flights.size(), 127u);
  EXPECT_EQ(report_->log.rows, 37082);
  EXPECT_EQ(report_->log.drop_outs, 45);
  EXPECT_GT(report_->log.climb_drift_m, 20.0) << "why the altitude is used";
}

TEST_F(M100Test, PredictsEnergyOfHeldOutFlights) {
  EXPECT_LE(Model("momentum").held_out.median_error_pct, 3.0);
  EXPECT_LE(Model("momentum").held_out.p90_error_pct, 8.0);
  EXPECT_GT(Model("paper").held_out.median_error_pct, 20.0) << "climbing for m g watts";
  EXPECT_EQ(report_->models[report_->best].name, "momentum");
}

TEST_F(M100Test, PredictsHoverPowerAtEachPayload) {
  ASSERT_EQ(Model("momentum").held_out.hover.size(), 3u);
  for (const HoverPower& hover : Model("momentum").held_out.hover)
    EXPECT_LE(std::abs(hover.ErrorPct()), 3.0) << hover.mass_kg << " kg";
  for (const HoverPower& hover : Model("momentum").held_out.hover)
    EXPECT_NEAR(hover.still_air_w / hover.measured_w, 1.0, 0.03)
        << hover.mass_kg << " kg: what a mission pays";
  EXPECT_LT(report_->scaling.low, 1.5);
  EXPECT_GT(report_->scaling.high, 1.5);
  EXPECT_NEAR(report_->scaling.exponent, 1.5, 0.1);
}

TEST_F(M100Test, FindsThePapersModelAtItsBounds) {
  const Estimate& paper = Model("paper").estimate;
  EXPECT_TRUE(paper.at_lower[1]) << "C_dh: cruise gets cheaper with speed";
  EXPECT_TRUE(paper.at_upper[2]) << "C_dv";
  EXPECT_TRUE(Model("momentum-isolated").estimate.at_upper[0]) << "without interference no efficiency fits";
}

TEST_F(M100Test, FindsPlausiblePhysics) {
  const ModelReport& momentum = Model("momentum");
  for (std::size_t i = 0; i < momentum.parameters.size(); ++i) {
    const Interval &flights = momentum.uncertainty.flights[i], &rows = momentum.uncertainty.rows[i];
    if (momentum.parameters[i].name == "profile_share") continue;  // only kappa + c_p is determined
    EXPECT_FALSE(momentum.estimate.at_lower[i] || momentum.estimate.at_upper[i])
        << momentum.parameters[i].name;
    EXPECT_LT(rows.standard_error, flights.standard_error) << "rows of a flight are not independent";
  }
  const double efficiency = momentum.estimate.values[0];
  EXPECT_GT(efficiency, 0.55);
  EXPECT_LT(efficiency, 0.9);
  const double hover_factor = momentum.estimate.values[1] + momentum.estimate.values[2];
  EXPECT_NEAR(efficiency / hover_factor, 0.49, 0.01) << "of ideal momentum theory";
}

TEST_F(M100Test, JsonAndParameterFileSayTheSame) {
  const nlohmann::ordered_json json = ToJson(*report_);
  EXPECT_EQ(json["judged_on"], "cross-validation");
  EXPECT_DOUBLE_EQ(json["models"]["momentum"]["median_flight_energy_error_pct"].get<double>(),
                   Model("momentum").held_out.median_error_pct);
  EXPECT_EQ(json["models"]["paper"]["parameters"]["C_dv"]["at_bound"], "upper");
  EXPECT_TRUE(json["models"]["paper"]["parameters"]["C_dv"]["ci95"].is_null());
  EXPECT_EQ(json["models"]["momentum"]["cross_validated"]["flights"].size(), 127u);

  const YAML::Node yaml = YAML::Load(FittedYaml(*report_));
  EXPECT_EQ(yaml["energy"]["model"].as<std::string>(), "momentum");
  EXPECT_NEAR(yaml["energy"]["induced_factor"].as<double>(), Model("momentum").estimate.values[1], 1e-5);
  EXPECT_DOUBLE_EQ(yaml["robot"]["mass_kg"].as<double>(), 3.68);
  EXPECT_DOUBLE_EQ(yaml["robot"]["drag_horizontal"].as<double>(), 0.0)
      << "a lower bound that the data hold on to";
  EXPECT_FALSE(yaml["robot"]["drag_vertical"]) << "an upper bound is no value";
  EXPECT_FALSE(Model("momentum-isolated").determination.Usable()) << "no efficiency is high enough";
}

// Wherever it ends before its end, it is refused or holds nothing.
TEST_F(M100Test, AParameterFileThatWasCutIsRefused) {
  const std::string whole = FittedYaml(*report_);
  const std::size_t first_key = whole.find("\nrobot:") + 1;
  EXPECT_EQ(ParseYaml("x.yaml", whole).root.entries.size(), 2u);
  for (std::size_t bytes = 0; bytes + 1 < whole.size(); ++bytes) {
    const std::string cut = whole.substr(0, bytes);
    try {
      EXPECT_EQ(ParseYaml("x.yaml", cut).root.kind, YamlNode::Kind::kNull) << cut;
      EXPECT_LT(bytes, first_key);
    } catch (const UserError& error) {
      EXPECT_STREQ(error.what(),
                   "x.yaml: is cut short: its last line, '# end of file', is missing; write it anew");
    }
  }
  std::string by_hand = whole.substr(0, first_key) + "robot:\n  mass_kg: 4\n# end of file  \r\n# mine\n";
  EXPECT_EQ(ParseYaml("x.yaml", by_hand).root.entries.size(), 1u);
  EXPECT_EQ(ParseYaml("x.yaml", "robot:\n  mass_kg: 4\n").root.entries.size(), 1u) << "announces nothing";
}

TEST_F(M100Test, PicturesOfAnotherFitDoNotStay) {
  const std::string folder = testing::TempDir() + "fit_outputs/";
  std::filesystem::create_directories(folder);
  for (const char* name : {"fit_energy.png", "fit_hover.svg", "plot.log", "mine.png"})
    std::ofstream(folder + name) << "of before";
  WriteFitOutputs(*report_, folder);
  for (const char* name : {"fit_energy.png", "fit_hover.svg", "plot.log"})
    EXPECT_FALSE(std::filesystem::exists(folder + name)) << name;
  for (const char* name : {"mine.png", "report.txt", "fit.json", "fitted.yaml", "flights.csv", "rows.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder + name)) << name;
  std::filesystem::remove_all(folder);
}

TEST_F(M100Test, TheShippedAirframeIsWhatAFitWrites) {
  std::string written = FittedYaml(*report_);
  const std::string source =
      std::string(ED3R_SOURCE_DIR) + "/";  // the command is given from the source folder
  if (const std::size_t at = written.find(source); at != std::string::npos) written.erase(at, source.size());
  EXPECT_EQ(written, ReadFile(kFlights + "m100_fitted.yaml"))
      << "ed3r fit sweeps/data/flight/m100_flights.csv --out DIR; cp DIR/fitted.yaml "
         "sweeps/data/flight/m100_fitted.yaml";
}

TEST_F(M100Test, WritesItsOutputs) {
  const std::string directory = ::testing::TempDir() + "ed3r_fit_outputs";
  WriteFitOutputs(*report_, directory);
  for (const char* name : {"report.txt", "fit.json", "fitted.yaml", "flights.csv", "rows.csv"})
    EXPECT_GT(std::filesystem::file_size(std::filesystem::path(directory) / name), 500u) << name;
  std::filesystem::remove_all(directory);
  EXPECT_THROW(WriteFitOutputs(*report_, "/proc/no/such/place"), UserError);
}

TEST(FitTest, EvaluatesFlightsThatTheFitNeverSaw) {
  const std::string train = Extract("fit_train.csv", [](int flight) { return flight < 120; });
  const std::string other =
      Extract("fit_other.csv", [](int flight) { return flight >= 180 && flight < 220; });
  const FitOptions options{.logs = {train}, .evaluate = {other}};
  const FitReport report = RunFit(options);
  const nlohmann::ordered_json json = ToJson(report);
  EXPECT_EQ(json["judged_on"], "evaluate");
  EXPECT_LE(json["models"]["momentum"]["median_flight_energy_error_pct"].get<double>(), 8.0);
  EXPECT_EQ(json["models"]["momentum"]["evaluated"]["flights"].size(), report.evaluate_log->flights.size());
  EXPECT_EQ(json.dump(), ToJson(RunFit(options)).dump()) << "deterministic";

  // What is evaluated must not change what is fitted.
  const FitReport alone = RunFit({.logs = {train}});
  EXPECT_EQ(alone.models.back().estimate.values, report.models.back().estimate.values);
}

TEST(FitTest, ReadsTheArduPilotLogOutOfTheBox) {
  const FitReport report = RunFit({.logs = {kFlights + "ardupilot_quad_log.csv"}, .format = "ardupilot"});
  EXPECT_TRUE(report.segments);
  EXPECT_EQ(report.log.flights.size(), 1u);
  EXPECT_GT(report.log.rows_on_ground, 500);
  ASSERT_EQ(report.models[0].held_out.hover.size(), 1u);
  EXPECT_NEAR(report.models[0].held_out.hover[0].measured_w, 224.0, 1.0);
  EXPECT_LE(report.models.back().held_out.median_error_pct, 5.0);
  EXPECT_TRUE(std::isnan(report.scaling.exponent)) << "one mass";
  std::ostringstream text;
  PrintReport(report, text);
  EXPECT_NE(text.str().find("segments of 10 s stand for flights"), std::string::npos);
}

TEST(FitTest, TakesTheAirframeFromSettings) {
  FitOptions options{.logs = {kFlights + "ardupilot_quad_log.csv"}, .format = "ardupilot"};
  options.robot = {{"robot.mass_kg", "1.5"}};
  EXPECT_DOUBLE_EQ(RunFit(options).log.flights[0].MassKg(), 1.5);
  options.robot = {{"robot.mas_kg", "1.5"}};
  EXPECT_THROW(RunFit(options), UserError);
  options.robot = {{"radio.target_dbm", "-80"}};
  EXPECT_THROW(RunFit(options), UserError);
}

}  // namespace
}  // namespace ed3r::fit
