#include "engine/rfnn/score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/rfnn/toys.h"

namespace ed3r::rfnn {
namespace {

using ::ed3r::testing::kTiny;

// relu(u) - relu(-u) = u: a network that returns its second input and ignores the first.
Model Identity() {
  ModelData data;
  data.weights = {0, 1, 0, -1, 0, 0, 1, -1, 0};
  data.scaling = {.input_mean = {0, 0}, .input_sd = {1, 1}, .target_mean = 0, .target_sd = 2};
  data.weights[6] = 0.5f;
  data.weights[7] = -0.5f;
  return Model(testing::kTiny, std::move(data));
}

TEST(ScoreTest, IsTheTextbooks) {
  DataSet data(2);
  const float inputs[][2] = {{5, 1}, {6, 2}, {7, 3}, {8, 100}};
  const float targets[] = {1, 4, 1, 0};
  for (int i = 0; i < 4; ++i) data.Add(inputs[i], targets[i], i / 2);
  const std::vector<std::uint32_t> rows = {0, 1, 2};  // errors 0, -2, 2; target mean 2
  const FitScore score = Score(Identity(), data, rows);
  EXPECT_EQ(score.rows, 3);
  EXPECT_EQ(score.missions, 2);
  EXPECT_NEAR(score.rmse, std::sqrt(8.0 / 3), 1e-12);
  EXPECT_NEAR(score.mse, 8.0 / 3 / 4, 1e-12);
  EXPECT_NEAR(score.mae, 4.0 / 3, 1e-12);
  EXPECT_NEAR(score.r2, 1 - 8.0 / 6, 1e-12);
}

TEST(ScoreTest, R2OfEqualTargetsIsNotANumber) {
  DataSet data(2);
  const float row[] = {0, 3};
  for (int i = 0; i < 3; ++i) data.Add(row, 3, i);
  const std::vector<std::uint32_t> rows = {0, 1, 2};
  EXPECT_TRUE(std::isnan(Score(Identity(), data, rows).r2));
  EXPECT_EQ(Score(Identity(), data, rows).mae, 0.0);
}

TEST(ScoreTest, ImportanceIsOfTheInputThatIsUsed) {
  DataSet data(2);
  Stream stream(5, 0, Purpose::kScenario);
  for (int i = 0; i < 4000; ++i) {
    const float row[] = {static_cast<float>(stream.Normal()), static_cast<float>(stream.Normal())};
    data.Add(row, row[1], i);
  }
  std::vector<std::uint32_t> rows(data.rows());
  std::iota(rows.begin(), rows.end(), 0u);
  const std::vector<double> importance = PermutationImportance(Identity(), data, rows, 1);
  ASSERT_EQ(importance.size(), 2u);
  EXPECT_EQ(importance[0], 0.0);
  EXPECT_NEAR(importance[1], 2.0, 0.15);  // R2 falls from 1 to 1 - 2 var / var
}

}  // namespace
}  // namespace ed3r::rfnn
