// The estimation against logs whose parameters are known.
#include "studies/fit/estimate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "studies/fit/assessment.h"
#include "studies/fit/self_check.h"
#include "studies/fit/uncertainty.h"

namespace ed3r::fit {
namespace {

class EstimateTest : public ::testing::Test {
 protected:
  const EnergyModel& Model(const std::string& name) const {
    for (const auto& model : models_)
      if (model->name() == name) return *model;
    throw InternalError(name);
  }

  FlightLog Log(const std::string& name, const SyntheticOptions& options) const {
    return MakeSyntheticLog(Model(name), PlausibleParameters(name), format_, options, 7, 0);
  }

  static Rows RowsOf(const FlightLog& log) {
    Rows rows;
    for (const Flight& flight : log.flights)
      for (const FlightRow& row : flight.rows) rows.push_back(&row);
    return rows;
  }

  LogFormat format_ = LoadLogFormat("m100");
  std::vector<std::unique_ptr<EnergyModel>> models_ = MakeEnergyModels(format_.robot, 9.8);
};

TEST_F(EstimateTest, DerivativesAgreeWithDifferences) {
  for (const auto& model : models_) {
    const std::vector<double> at = PlausibleParameters(model->name());
    FlightRow row{.density_kgm3 = 1.2, .mass_kg = 4.0};
    for (const double speed : {0.0, 3.0, 12.0}) {
      for (const double climb : {-9.0, -2.0, 0.0, 3.0}) {  // -9: beyond the limit of the hover branch
        row.airspeed_mps = speed;
        row.climb_mps = climb;
        std::vector<double> gradient(at.size());
        EXPECT_DOUBLE_EQ(model->PowerW(row, at.data(), gradient.data()), model->PowerW(row, at.data()));
        for (std::size_t i = 0; i < at.size(); ++i) {
          std::vector<double> up = at, down = at;
          up[i] += 1e-6;
          down[i] -= 1e-6;
          const double slope = (model->PowerW(row, up.data()) - model->PowerW(row, down.data())) / 2e-6;
          EXPECT_NEAR(gradient[i], slope, 1e-3 + 1e-5 * std::abs(slope))
              << model->name() << " " << model->parameters()[i].name << " at " << speed << ", " << climb;
        }
      }
    }
  }
}

TEST_F(EstimateTest, WhatAFitMayFindASweepMaySet) {
  for (const auto& model : models_)
    for (const ParameterSpec& spec : model->parameters()) {
      Config config;
      for (const double value : {spec.lower, spec.start, spec.upper})
        EXPECT_EQ(SetParameter(config, spec.key, fmt::format("{}", value)), "") << model->name();
      EXPECT_LT(spec.lower, spec.upper) << spec.key;
    }
}

TEST_F(EstimateTest, RecoversEveryModelFromNoiseAndOutliersWithinOnePercent) {
  SyntheticOptions options;
  options.flights = 300;
  options.rows_per_flight = 500;
  for (const std::string name : {"paper-climb", "momentum-isolated", "momentum"}) {
    const std::vector<double> truth = PlausibleParameters(name);
    const FlightLog log = Log(name, options);
    const Estimate estimate = EstimateParameters(Model(name), RowsOf(log));
    EXPECT_EQ(estimate.starts_agreeing, estimate.starts) << name;
    EXPECT_EQ(estimate.loss, Loss::kTukey);
    EXPECT_GT(estimate.beyond_low + estimate.beyond_high, 1000) << "the outliers, about 1 % of the rows";
    for (std::size_t i = 0; i < truth.size(); ++i)
      EXPECT_NEAR(estimate.values[i] / truth[i], 1.0, 0.01)
          << name << " " << Model(name).parameters()[i].name;
  }
}

TEST_F(EstimateTest, OneSidedDropOutsDoNotBiasIt) {
  SyntheticOptions clean, dirty;
  clean.outlier_share = 0.0;
  dirty.outlier_share = 0.05;
  dirty.drop_out_share = 1.0;
  const Estimate without = EstimateParameters(Model("momentum"), RowsOf(Log("momentum", clean)));
  const FlightLog log = Log("momentum", dirty);
  const Estimate with = EstimateParameters(Model("momentum"), RowsOf(log));
  const Uncertainty uncertainty = EstimateUncertainty(Model("momentum"), log.flights, with);
  EXPECT_GT(with.beyond_low, 200);
  EXPECT_LT(with.beyond_high, 10);
  for (std::size_t i = 0; i < with.values.size();
       ++i)  // the same noise otherwise: far less than its own error
    EXPECT_LT(std::abs(with.values[i] - without.values[i]), uncertainty.flights[i].standard_error);
}

TEST_F(EstimateTest, ReportsParametersAtTheirBounds) {
  // Logs of the physical model: climbing costs far more than m g watts, and cruise gets cheaper with speed.
  const FlightLog log = Log("momentum", {});
  const EnergyModel& paper = Model("paper");
  const Estimate estimate = EstimateParameters(paper, RowsOf(log));
  const Uncertainty uncertainty = EstimateUncertainty(paper, log.flights, estimate);
  EXPECT_EQ(estimate.loss, Loss::kHuber) << "what the model cannot explain is not an outlier";
  // Its drag adds to a climb what it takes from a descent, so a large C_dv helps neither: the lower bound.
  EXPECT_TRUE(estimate.at_lower[2]) << "C_dv " << estimate.values[2];
  EXPECT_EQ(estimate.values[2], paper.parameters()[2].lower);
  EXPECT_TRUE(std::isnan(uncertainty.flights[2].low));
  EXPECT_FALSE(std::isnan(uncertainty.flights[0].low));
}

TEST_F(EstimateTest, AStartNearTheSolutionFindsTheSame) {
  const FlightLog log = Log("momentum", {});
  const Estimate full = EstimateParameters(Model("momentum"), RowsOf(log));
  const Estimate near = EstimateParameters(Model("momentum"), RowsOf(log), full);
  for (std::size_t i = 0; i < full.values.size(); ++i)
    EXPECT_NEAR(near.values[i], full.values[i], 1e-4 * full.values[i]);
}

TEST_F(EstimateTest, SaysWhenTheDataDoNotDetermineTheParameters) {
  FlightLog log = Log("momentum", {});
  for (Flight& flight : log.flights)  // hovering at one mass: only kappa + c_p over the efficiency is seen
    for (FlightRow& row : flight.rows) row.airspeed_mps = row.climb_mps = 0.0, row.mass_kg = 4.0;
  const EnergyModel& model = Model("momentum");
  Estimate estimate = EstimateParameters(model, RowsOf(log));
  estimate.at_lower.assign(5, false);
  estimate.at_upper.assign(5, false);
  const Uncertainty uncertainty = EstimateUncertainty(model, log.flights, estimate);
  EXPECT_FALSE(uncertainty.determined);
  for (const Interval& interval : uncertainty.flights) EXPECT_TRUE(std::isnan(interval.low));
}

TEST_F(EstimateTest, HeldOutFlightsDoNotReachTheirOwnPrediction) {
  SyntheticOptions options;
  options.flights = 20;
  FlightLog log = Log("paper-climb", options);
  const EnergyModel& model = Model("paper-climb");
  const Estimate full = EstimateParameters(model, RowsOf(log));
  const Predictions before = CrossValidate(model, log.flights, full);
  for (FlightRow& row : log.flights[3].rows) row.power_w *= 1.02;
  const Predictions after = CrossValidate(model, log.flights, full);
  for (std::size_t i = 0; i < before[3].size(); ++i)
    EXPECT_NEAR(after[3][i] / before[3][i], 1.0, 1e-6) << "flight 3 and 13 are the same fold";
  EXPECT_GT(std::abs(after[4][0] / before[4][0] - 1.0), 1e-4) << "flight 4 learns from flight 3";
}

// The full study is 1,000 fits; the pooled coverage of 80 fits x 5 parameters has a standard error near 1 %.
TEST(SelfCheckTest, IntervalsHoldTheTruthAsOftenAsTheySay) {
  SelfCheckOptions options;
  options.fits = 80;
  options.log.rows_per_flight = 40;
  const SelfCheckReport report = RunSelfCheck(options);
  double pooled = 0.0;
  for (std::size_t i = 0; i < report.parameters.size(); ++i) {
    EXPECT_GE(report.CoverageFlightsPct(i), 88.0) << report.parameters[i].name;
    pooled += report.CoverageFlightsPct(i) / static_cast<double>(report.parameters.size());
  }
  EXPECT_GE(pooled, 91.0);
  EXPECT_LE(pooled, 98.0);
}

TEST(SelfCheckTest, OnlyIntervalsByFlightSurviveCorrelationWithinFlights) {
  SelfCheckOptions options;
  options.model = "paper-climb";
  options.fits = 100;
  options.log.rows_per_flight = 40;
  options.log.correlation = 0.5;
  options.log.flight_share = 0.03;
  const SelfCheckReport report = RunSelfCheck(options);
  EXPECT_GE(report.CoverageFlightsPct(0), 88.0);
  EXPECT_LE(report.CoverageRowsPct(0), 70.0) << "as-if-independent intervals are far too narrow";
}

TEST(StudentTest, MatchesTheTables) {
  EXPECT_NEAR(StudentT95(3), 3.182, 0.004);
  EXPECT_NEAR(StudentT95(10), 2.228, 0.001);
  EXPECT_NEAR(StudentT95(126), 1.979, 0.001);
}

}  // namespace
}  // namespace ed3r::fit
