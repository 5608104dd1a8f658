#include "engine/rfnn/scaling.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/rfnn/toys.h"

namespace ed3r::rfnn {
namespace {

using ::ed3r::testing::ToyData;

TEST(ScalingTest, TrainingRowsGetMeanZeroAndSpreadOne) {
  const DataSet data = testing::ToyData(10, 200, 0.3);
  std::vector<std::uint32_t> rows(1500);
  std::iota(rows.begin(), rows.end(), 200u);
  const Scaling scaling = FitScaling(data, rows);
  const InputScaler scaler(scaling);
  for (int c = 0; c < data.columns; ++c) {
    double sum = 0, squares = 0;
    for (const std::uint32_t r : rows) {
      float x[4];
      scaler.Standardize(data.row(r), 0, x);
      sum += x[c];
      squares += static_cast<double>(x[c]) * x[c];
    }
    EXPECT_NEAR(sum / 1500, 0.0, 1e-6) << c;
    EXPECT_NEAR(squares / 1500, 1.0, 1e-6) << c;
  }
}

TEST(ScalingTest, RowsThatAreNotGivenDoNotCount) {
  DataSet data = testing::ToyData(10, 20, 0.3);
  const std::vector<std::uint32_t> rows = {3, 5, 8, 13};
  const Scaling before = FitScaling(data, rows);
  data.inputs[0] = 1e6f;
  data.targets[1] = 1e6f;
  const Scaling after = FitScaling(data, rows);
  EXPECT_EQ(before.input_mean, after.input_mean);
  EXPECT_EQ(before.target_sd, after.target_sd);
}

TEST(ScalingTest, TargetsComeBack) {
  const DataSet data = testing::ToyData(10, 50, 0.3);
  std::vector<std::uint32_t> rows(data.rows());
  std::iota(rows.begin(), rows.end(), 0u);
  const Scaling scaling = FitScaling(data, rows);
  for (const float target : data.targets)
    EXPECT_NEAR(RawTarget(scaling, StandardizeTarget(scaling, target)), target, 1e-6);
}

TEST(ScalingTest, StateAndActionApartAreTheWholeRow) {
  const DataSet data = testing::ToyData(2, 5, 0.3);
  const std::vector<std::uint32_t> rows = {0, 1, 2, 3, 4, 5, 6};
  const InputScaler scaler(FitScaling(data, rows));
  float whole[4], parts[4];
  scaler.Standardize(data.row(8), 0, whole);
  scaler.Standardize(data.row(8).first(3), 0, parts);
  scaler.Standardize(data.row(8).last(1), 3, parts + 3);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(whole[i], parts[i]);
}

TEST(ScalingTest, AConstantInputBecomesZeroWhereverItGoes) {
  DataSet data(2);
  for (int i = 0; i < 7; ++i) {
    const float row[] = {0.1f, static_cast<float>(i)};
    data.Add(row, 5.3f, i);
  }
  const std::vector<std::uint32_t> rows = {0, 1, 2, 3, 4, 5, 6};
  const Scaling scaling = FitScaling(data, rows);
  EXPECT_EQ(scaling.input_sd[0], 0.0);
  EXPECT_EQ(scaling.target_sd, 1.0);
  const float row[] = {400.0f, 3.0f};
  float x[2];
  InputScaler(scaling).Standardize(row, 0, x);
  EXPECT_EQ(x[0], 0.0f);
  EXPECT_EQ(x[1], 0.0f);
}

}  // namespace
}  // namespace ed3r::rfnn
