#include "engine/rfnn/training_report.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace ed3r::rfnn {
namespace {

TrainingReport Sample() {
  TrainingReport report;
  report.curve = {{1.0, 0.9}, {0.1 + 0.2, 1e-17}};
  report.best_epoch = 2;
  report.stopped_early = true;
  report.test = {.rows = 50, .missions = 3, .mse = 0.25, .r2 = 0.75, .mae = 0.5, .rmse = 0.6};
  report.train.r2 = std::numeric_limits<double>::quiet_NaN();
  return report;
}

TEST(ReportTest, CurveAsCsvKeepsEveryBit) {
  EXPECT_EQ(LossCurveCsv(Sample()), "epoch,train_mse,validation_mse\n1,1,0.9\n2,0.30000000000000004,1e-17\n");
}

TEST(ReportTest, JsonHoldsAll) {
  const auto json = nlohmann::json::parse(ReportJson(Sample()));
  EXPECT_EQ(json["epochs"], 2);
  EXPECT_EQ(json["best_epoch"], 2);
  EXPECT_EQ(json["stopped_early"], true);
  EXPECT_EQ(json["test"]["missions"], 3);
  EXPECT_EQ(json["test"]["r2"], 0.75);
  EXPECT_EQ(json["test"]["mae"], 0.5);
  EXPECT_TRUE(json["train"]["r2"].is_null());
  EXPECT_EQ(json["curve"]["train_mse"][1].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(json["curve"]["validation_mse"].size(), 2u);
}

}  // namespace
}  // namespace ed3r::rfnn
