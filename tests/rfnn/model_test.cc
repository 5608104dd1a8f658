#include "engine/rfnn/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "engine/core/check.h"
#include "tests/rfnn/toys.h"

namespace ed3r::rfnn {
namespace {

using ::ed3r::testing::kToy;
using ::ed3r::testing::RandomModel;

// The network in plain double arithmetic, from its definition.
double Reference(const Model& model, std::vector<double> x) {
  const ModelData& data = model.data();
  const kernels::DenseShape shape = ShapeOf(model.design());
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = (x[i] - data.scaling.input_mean[i]) / data.scaling.input_sd[i];
  const float* w = data.weights.data();
  for (int l = 0; l < shape.layers; ++l) {
    const int in = shape.sizes[l], out = shape.sizes[l + 1];
    std::vector<double> y(static_cast<std::size_t>(out));
    for (int o = 0; o < out; ++o) {
      double sum = w[in * out + o];
      for (int i = 0; i < in; ++i) sum += static_cast<double>(w[o * in + i]) * x[static_cast<std::size_t>(i)];
      y[static_cast<std::size_t>(o)] = l + 1 < shape.layers ? std::max(0.0, sum) : sum;
    }
    w += (in + 1) * out;
    x = y;
  }
  return data.scaling.target_mean + data.scaling.target_sd * x[0];
}

struct Question {
  std::vector<double> state;
  std::vector<float> actions;
};

Question Ask(const NetworkDesign& design, int n, std::uint64_t seed) {
  Stream stream(seed, 1, Purpose::kCandidates);
  Question q;
  for (int i = 0; i < design.states; ++i) q.state.push_back(stream.Uniform(-6, 6));
  for (int i = 0; i < n * design.actions(); ++i)
    q.actions.push_back(static_cast<float>(stream.Uniform(-6, 6)));
  return q;
}

std::span<const float> ActionOf(const Model& model, const Question& q, int i) {
  const auto actions = static_cast<std::size_t>(model.design().actions());
  return std::span(q.actions).subspan(static_cast<std::size_t>(i) * actions, actions);
}

TEST(ModelTest, PredictsWhatTheDefinitionSays) {
  for (const NetworkDesign& design : {kRcNetwork, kRobotNetwork, testing::kToy}) {
    const Model model(design, testing::RandomModel(design, 11));
    Model::Workspace workspace;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Question q = Ask(design, 1, seed);
      std::vector<double> x(q.state);
      x.insert(x.end(), q.actions.begin(), q.actions.end());
      const double expected = Reference(model, x);
      EXPECT_NEAR(model.Predict(q.state, q.actions, workspace), expected, 1e-4 * (1 + std::abs(expected)));
    }
  }
}

TEST(ModelTest, BestIsTheArgmaxOfSinglePredictionsBitForBit) {
  for (const NetworkDesign& design : {kRcNetwork, kRobotNetwork}) {
    const Model model(design, testing::RandomModel(design, 12));
    Model::Workspace workspace;
    for (const int n : {1, 2, 3, 8, 9, 47, 48, 49, 1000}) {
      const Question q = Ask(design, n, static_cast<std::uint64_t>(n));
      int best = 0;
      std::vector<double> predicted;
      for (int i = 0; i < n; ++i) {
        predicted.push_back(model.Predict(q.state, ActionOf(model, q, i), workspace));
        if (predicted.back() > predicted[static_cast<std::size_t>(best)]) best = i;
      }
      const BestAction answer = model.Best(q.state, q.actions, workspace);
      EXPECT_EQ(answer.index, best);
      EXPECT_EQ(answer.reward, predicted[static_cast<std::size_t>(best)]);
      std::vector<double> rewards(static_cast<std::size_t>(n));
      EXPECT_EQ(model.Best(q.state, q.actions, rewards, workspace).index, best);
      EXPECT_EQ(rewards, predicted);
    }
  }
}

TEST(ModelTest, RowsAgreeWithDecisionsBitForBit) {
  const Model model(kRcNetwork, testing::RandomModel(kRcNetwork, 13));
  Model::Workspace workspace;
  const Question q = Ask(kRcNetwork, 100, 3);
  std::vector<double> rewards(100), rows_rewards(100);
  model.Best(q.state, q.actions, rewards, workspace);
  std::vector<float> rows;
  for (int i = 0; i < 100; ++i) {
    for (const double s : q.state) rows.push_back(static_cast<float>(s));
    const auto action = ActionOf(model, q, i);
    rows.insert(rows.end(), action.begin(), action.end());
  }
  model.PredictRows(rows, rows_rewards, workspace);
  EXPECT_EQ(rewards, rows_rewards);
}

TEST(ModelTest, EqualActionsGoToTheLowestIndex) {
  const Model model(testing::kToy, testing::RandomModel(testing::kToy, 14));
  Model::Workspace workspace;
  const std::vector<double> state = {1, 2, 3};
  for (const std::size_t n : {3u, 20u})
    EXPECT_EQ(model.Best(state, std::vector<float>(n, 0.5f), workspace).index, 0);
}

TEST(ModelTest, EveryLevelGivesTheSameBits) {
  const Model model(kRcNetwork, testing::RandomModel(kRcNetwork, 15));
  const Question q = Ask(kRcNetwork, 333, 4);
  Model::Workspace scalar(kernels::SimdLevel::kScalar);
  std::vector<double> expected(333), found(333);
  const BestAction best = model.Best(q.state, q.actions, expected, scalar);
  for (const kernels::SimdLevel level : {kernels::SimdLevel::kAvx2, kernels::SimdLevel::kAvx512}) {
    if (!kernels::SimdLevelSupported(level)) continue;
    Model::Workspace workspace(level);
    EXPECT_EQ(model.Best(q.state, q.actions, found, workspace).index, best.index);
    EXPECT_EQ(found, expected) << kernels::SimdLevelName(level);
  }
}

TEST(ModelTest, OneWorkspaceServesModelsOfAnySize) {
  const Model small(testing::kToy, testing::RandomModel(testing::kToy, 16)),
      large(kRcNetwork, testing::RandomModel(kRcNetwork, 17));
  Model::Workspace shared;
  const Question q_small = Ask(testing::kToy, 5, 1), q_large = Ask(kRcNetwork, 700, 1);
  for (int round = 0; round < 2; ++round) {
    Model::Workspace own_small, own_large;
    EXPECT_EQ(small.Best(q_small.state, q_small.actions, shared).reward,
              small.Best(q_small.state, q_small.actions, own_small).reward);
    EXPECT_EQ(large.Best(q_large.state, q_large.actions, shared).reward,
              large.Best(q_large.state, q_large.actions, own_large).reward);
  }
}

TEST(ModelTest, ThreadsWithTheirOwnWorkspacesDoNotDisturbEachOther) {
  const Model model(kRobotNetwork, testing::RandomModel(kRobotNetwork, 18));
  std::vector<BestAction> found(64), expected(64);
  const auto answer = [&](std::size_t i, Model::Workspace& workspace) {
    const Question q = Ask(kRobotNetwork, 3, i);
    return model.Best(q.state, q.actions, workspace);
  };
  Model::Workspace workspace;
  for (std::size_t i = 0; i < 64; ++i) expected[i] = answer(i, workspace);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      Model::Workspace own;
      for (std::size_t i = t; i < 64; i += 4) found[i] = answer(i, own);
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_EQ(found[i].index, expected[i].index);
    EXPECT_EQ(found[i].reward, expected[i].reward);
  }
}

TEST(ModelTest, RefusesWrongSizesAndPredictionsThatAreNotNumbers) {
  const Model model(testing::kToy, testing::RandomModel(testing::kToy, 19));
  Model::Workspace workspace;
  const std::vector<float> action = {0.5f}, none;
  std::vector<double> two_rewards(2);
  const std::vector<double> state = {1, 2, 3}, wide = {1, 2, 3, 4},
                            broken = {1, std::numeric_limits<double>::quiet_NaN(), 3};
  EXPECT_THROW(model.Best(wide, action, workspace), InternalError);
  EXPECT_THROW(model.Best(state, none, workspace), InternalError);
  EXPECT_THROW(model.Best(state, action, two_rewards, workspace), InternalError);
  EXPECT_THROW(model.Best(broken, action, workspace), InternalError);
  ModelData short_of_weights = testing::RandomModel(testing::kToy, 20);
  short_of_weights.weights.pop_back();
  EXPECT_THROW(Model(testing::kToy, std::move(short_of_weights)), InternalError);
}

}  // namespace
}  // namespace ed3r::rfnn
