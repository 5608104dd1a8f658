#include "kernels/train.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "tests/kernels/reference.h"

namespace ed3r::kernels {
namespace {

struct Data {
  Data(int inputs, int n, std::mt19937* rng)
      : inputs(RandomFloats(n * inputs, rng)), targets(RandomFloats(n, rng)) {}

  std::vector<float> inputs, targets;
};

std::vector<std::uint32_t> FirstRows(int n) {
  std::vector<std::uint32_t> rows(n);
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

std::vector<float> ParametersOf(const DenseTrainer& trainer, std::size_t count) {
  std::vector<float> flat(count);
  trainer.Parameters(flat.data());
  return flat;
}

std::vector<float> GradientOf(const DenseTrainer& trainer, std::size_t count) {
  std::vector<float> flat(count);
  trainer.Gradient(flat.data());
  return flat;
}

// Small enough that a step changes nothing that a test looks at.
constexpr double kStandStill = 1e-30;

// The draws of step `step` as dense_kernels.h defines them.
class ReferenceDropout {
 public:
  ReferenceDropout(const DenseShape& shape, double p, std::uint64_t seed, std::uint64_t step)
      : shape_(shape), p_(p), stream_(Mix(Mix(seed + 0x9e3779b97f4a7c15u) + step)) {}

  double Factor(int row, int layer, int neuron) const {  // layer: of the activations, 1 = first hidden
    int hidden = 0, first = 0;
    for (int l = 1; l < shape_.layers; ++l) {
      if (l == layer) first = hidden;
      hidden += PadToBlock(shape_.sizes[l]);
    }
    const std::uint32_t y = Key(first + neuron) ^ Key(hidden + row);
    const auto z = static_cast<std::int32_t>((y ^ (y >> 15)) * 0x846ca68bu);
    return z / 4294967296.0 + 0.5 < p_ ? 0.0 : 1.0 / (1.0 - p_);
  }

 private:
  static std::uint64_t Mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint32_t Key(int k) const {
    const std::uint64_t draw = Mix(stream_ + static_cast<std::uint64_t>(k / 2 * 2) * 0x9e3779b97f4a7c15u);
    return static_cast<std::uint32_t>(k % 2 ? draw >> 32 : draw);
  }

  DenseShape shape_;
  double p_;
  std::uint64_t stream_;
};

// Mean squared error in double precision.
double ReferenceLoss(const DenseShape& shape, const std::vector<double>& flat, const Data& data, int n,
                     const ReferenceDropout& dropout) {
  double squares = 0;
  for (int r = 0; r < n; ++r) {
    std::vector<double> h(data.inputs.begin() + r * shape.inputs(),
                          data.inputs.begin() + (r + 1) * shape.inputs());
    const double* w = flat.data();
    for (int l = 0; l < shape.layers; ++l) {
      const int in = shape.sizes[l], out = shape.sizes[l + 1];
      std::vector<double> next(out);
      for (int o = 0; o < out; ++o) {
        next[o] = w[static_cast<std::size_t>(in) * out + o];
        for (int i = 0; i < in; ++i) next[o] += w[static_cast<std::size_t>(o) * in + i] * h[i];
        if (l + 1 < shape.layers) next[o] = std::max(0.0, next[o]) * dropout.Factor(r, l + 1, o);
      }
      h = next;
      w += static_cast<std::size_t>(in + 1) * out;
    }
    squares += (h[0] - data.targets[r]) * (h[0] - data.targets[r]);
  }
  return squares / n;
}

TEST(TrainTest, GradientMatchesFiniteDifferences) {
  std::mt19937 rng(1);
  for (const std::vector<int>& sizes :
       std::vector<std::vector<int>>{{13, 40, 24, 1}, {5, 17, 33, 9, 1}, {4, 1}, {3, 8, 1}})
    for (double p : {0.0, 0.1, 0.5})
      for (int n : {1, 7, 32, 77}) {
        const DenseShape shape = ShapeOf(sizes);
        const Data data(sizes[0], n, &rng);
        const std::vector<float> flat = RandomFloats(ParameterCount(shape), &rng, 0.5f);
        TrainOptions options;
        options.learning_rate = kStandStill;
        options.dropout = p;
        options.seed = 77;
        DenseTrainer trainer(shape, flat.data(), options);
        const double loss = trainer.Step(data.inputs.data(), data.targets.data(), FirstRows(n).data(), n);
        const ReferenceDropout dropout(shape, p, 77, 1);
        std::vector<double> exact(flat.begin(), flat.end());
        EXPECT_NEAR(loss, ReferenceLoss(shape, exact, data, n, dropout), 1e-5 * (1 + loss));
        const std::vector<float> gradient = GradientOf(trainer, flat.size());
        for (std::size_t k = 0; k < flat.size(); k += 1 + rng() % 15) {
          const double step = 1e-6, w = exact[k];
          exact[k] = w + step;
          const double up = ReferenceLoss(shape, exact, data, n, dropout);
          exact[k] = w - step;
          const double down = ReferenceLoss(shape, exact, data, n, dropout);
          exact[k] = w;
          ASSERT_NEAR(gradient[k], (up - down) / (2 * step), 3e-5)
              << "parameter " << k << ", n " << n << ", p " << p;
        }
      }
}

TEST(TrainTest, AdamFollowsItsDefinition) {
  std::mt19937 rng(2);
  const DenseShape shape = ShapeOf({6, 20, 1});
  const Data data(6, 500, &rng);
  std::vector<float> flat = RandomFloats(ParameterCount(shape), &rng, 0.4f);
  TrainOptions options;
  options.learning_rate = 1e-2;
  DenseTrainer trainer(shape, flat.data(), options);
  std::vector<double> w(flat.begin(), flat.end()), m(w.size()), v(w.size());
  for (int t = 1; t <= 200; ++t) {
    std::vector<std::uint32_t> rows(128);
    for (std::uint32_t& r : rows) r = rng() % 500;
    trainer.Step(data.inputs.data(), data.targets.data(), rows.data(), 128);
    const std::vector<float> g = GradientOf(trainer, w.size()), now = ParametersOf(trainer, w.size());
    for (std::size_t k = 0; k < w.size(); ++k) {
      m[k] = 0.9 * m[k] + (1 - 0.9) * g[k];
      v[k] = 0.999 * v[k] + (1 - 0.999) * g[k] * g[k];
      const double corrected_m = m[k] / (1 - std::pow(0.9, t)), corrected_v = v[k] / (1 - std::pow(0.999, t));
      w[k] -= 1e-2 * corrected_m / (std::sqrt(corrected_v) + 1e-8);
      ASSERT_NEAR(now[k], w[k], 2e-6) << "parameter " << k << ", step " << t;  // 200 roundings of a float
    }
  }
  EXPECT_EQ(trainer.steps(), 200u);
}

TEST(TrainTest, LevelsAgreeBitwiseOverAHundredSteps) {
  std::mt19937 rng(3);
  struct Case {
    std::vector<int> sizes;
    double dropout;
  };
  for (const auto& [sizes, dropout] : std::vector<Case>{{kRcSizes, 0.1},
                                                        {kRobotSizes, 0.0},
                                                        {{5, 19, 40, 7, 1}, 0.5},
                                                        {{5, 16, 1}, 1 - 1e-12},
                                                        {{9, 1}, 0.1}}) {
    const DenseShape shape = ShapeOf(sizes);
    const Data data(sizes[0], 700, &rng);
    const std::vector<float> flat = RandomFloats(ParameterCount(shape), &rng, 0.2f);
    std::vector<DenseTrainer> trainers;
    for (SimdLevel level : LevelsHere()) {
      TrainOptions options;
      options.level = level;
      options.dropout = dropout;
      options.learning_rate = 1e-3;
      trainers.emplace_back(shape, flat.data(), options);
    }
    for (int step = 0; step < 100; ++step) {
      const int n = step % 3 ? 128 : std::vector<int>{1, 17, 64, 65, 86, 127}[step / 3 % 6];
      std::vector<std::uint32_t> rows(n);
      for (std::uint32_t& r : rows) r = rng() % 700;
      std::vector<double> losses;
      for (DenseTrainer& trainer : trainers)
        losses.push_back(trainer.Step(data.inputs.data(), data.targets.data(), rows.data(), n));
      for (double loss : losses) ASSERT_EQ(loss, losses[0]) << "step " << step;
    }
    const std::vector<float> expected = ParametersOf(trainers[0], flat.size());
    EXPECT_NE(expected, flat);
    for (const DenseTrainer& trainer : trainers)
      EXPECT_EQ(Bits(ParametersOf(trainer, flat.size())), Bits(expected));
  }
}

TEST(TrainTest, ThreadsChangeNothing) {
  std::mt19937 rng(4);
  const DenseShape shape = ShapeOf(kRcSizes);
  const Data data(13, 3000, &rng);
  const std::vector<float> flat = RandomFloats(ParameterCount(shape), &rng, 0.2f);
  std::vector<float> expected;
  double evaluated = 0;
  for (int threads : {1, 2, 3, 4, 9}) {
    TrainOptions options;
    options.threads = threads;
    options.learning_rate = 1e-3;
    DenseTrainer trainer(shape, flat.data(), options);
    std::vector<std::uint32_t> rows = FirstRows(128);
    for (int step = 0; step < 30; ++step) {
      for (std::uint32_t& r : rows) r = (r + 91) % 3000;
      trainer.Step(data.inputs.data(), data.targets.data(), rows.data(), 128 - step % 5);
    }
    const double loss = trainer.Evaluate(data.inputs.data(), data.targets.data(), 3000);
    if (threads == 1) {
      expected = ParametersOf(trainer, flat.size());
      evaluated = loss;
    }
    EXPECT_EQ(Bits(ParametersOf(trainer, flat.size())), Bits(expected)) << threads << " threads";
    EXPECT_EQ(loss, evaluated) << threads << " threads";
  }
}

// With one input of 1, weights of 1 and no biases, a hidden neuron is 1 / (1 - p), or 0 where it was dropped;
// the gradient of its output weight tells which.
class DropoutTest : public testing::Test {
 protected:
  static constexpr int kNeurons = 4096;

  std::vector<bool> Dropped(double p, std::uint64_t seed, int step, int row) {
    const DenseShape shape = ShapeOf({1, kNeurons, 1});
    std::vector<float> flat(ParameterCount(shape), 0.0f);
    std::fill_n(flat.begin(), kNeurons, 1.0f);
    const std::vector<float> inputs = {1.0f, 0.0f}, targets = {1.0f, 0.0f};  // row 1 adds nothing
    std::vector<std::uint32_t> rows(row + 1, 1u);
    rows[row] = 0;
    TrainOptions options;
    options.dropout = p;
    options.seed = seed;
    options.learning_rate = kStandStill;
    DenseTrainer trainer(shape, flat.data(), options);
    for (int k = 0; k < step; ++k) trainer.Step(inputs.data(), targets.data(), rows.data(), row + 1);
    const std::vector<float> gradient = GradientOf(trainer, flat.size());
    std::vector<bool> dropped(kNeurons);
    for (int j = 0; j < kNeurons; ++j) {
      const float g = gradient[2 * kNeurons + j];
      dropped[j] = g == 0.0f;
      if (!dropped[j]) {
        EXPECT_FLOAT_EQ(g, -2.0 / (row + 1) / (1 - p));
      }
    }
    return dropped;
  }
};

TEST_F(DropoutTest, DropsTheShareThatIsAsked) {
  for (double p : {0.0, 0.1, 0.5, 0.9}) {
    long dropped = 0;
    for (std::uint64_t seed = 0; seed < 5; ++seed)
      for (int step : {1, 2, 3}) {
        const std::vector<bool> mask = Dropped(p, seed, step, 0);
        dropped += std::count(mask.begin(), mask.end(), true);
      }
    const double n = 15.0 * kNeurons;
    EXPECT_NEAR(dropped / n, p, 4.5 * std::sqrt(p * (1 - p) / n)) << p;
  }
}

TEST_F(DropoutTest, DrawsAreIndependent) {
  const double p = 0.3;
  const std::vector<bool> base = Dropped(p, 1, 1, 0);
  EXPECT_EQ(Dropped(p, 1, 1, 0), base);
  const double tolerance = 4.5 * std::sqrt(p * p * (1 - p * p) / kNeurons);
  const auto both = [&](const std::vector<bool>& other, int shift) {
    int count = 0;
    for (int j = 0; j < kNeurons; ++j) count += base[j] && other[(j + shift) % kNeurons];
    return static_cast<double>(count) / kNeurons;
  };
  for (int shift : {1, 2, 8, 16, 512})
    EXPECT_NEAR(both(base, shift), p * p, tolerance) << "neurons apart " << shift;
  EXPECT_NEAR(both(Dropped(p, 1, 2, 0), 0), p * p, tolerance) << "next step";
  EXPECT_NEAR(both(Dropped(p, 2, 1, 0), 0), p * p, tolerance) << "next seed";
  EXPECT_NEAR(both(Dropped(p, 1, 1, 1), 0), p * p, tolerance) << "next row";
  EXPECT_NEAR(both(Dropped(p, 1, 1, 70), 0), p * p, tolerance) << "row of the next sub-block";
}

TEST(TrainTest, EvaluateIsTheErrorOfInference) {
  std::mt19937 rng(5);
  const DenseShape shape = ShapeOf(kRobotSizes);
  const Data data(11, 2500, &rng);
  const TestNet net(kRobotSizes, &rng);
  TrainOptions options;
  DenseTrainer trainer(shape, net.flat.data(), options);
  for (int n : {1, 8, 9, 1024, 1025, 2500}) {
    std::vector<float> values(n);
    RfnnValues(trainer.net(), data.inputs.data(), n, values.data(), net.workspace.data());
    double squares = 0;
    for (int r = 0; r < n; ++r) squares += std::pow(static_cast<double>(values[r]) - data.targets[r], 2);
    EXPECT_NEAR(trainer.Evaluate(data.inputs.data(), data.targets.data(), n), squares / n,
                1e-13 * squares / n);
  }
  EXPECT_EQ(trainer.Evaluate(data.inputs.data(), data.targets.data(), 0), 0.0);
}

TEST(TrainTest, NetworkViewIsThePresentParameters) {
  std::mt19937 rng(6);
  const DenseShape shape = ShapeOf({5, 30, 1});
  const Data data(5, 64, &rng);
  const std::vector<float> flat = RandomFloats(ParameterCount(shape), &rng);
  TrainOptions options;
  options.learning_rate = 1e-2;
  DenseTrainer trainer(shape, flat.data(), options);
  EXPECT_EQ(ParametersOf(trainer, flat.size()), flat);
  trainer.Step(data.inputs.data(), data.targets.data(), FirstRows(64).data(), 64);
  const std::vector<float> after = ParametersOf(trainer, flat.size());
  EXPECT_NE(after, flat);
  AlignedFloats workspace(RfnnWorkspaceFloats(shape));
  float value = 0;
  RfnnValues(trainer.net(), data.inputs.data(), 1, &value, workspace.data());
  EXPECT_EQ(Bits(value), Bits(ReferenceValue(shape, after, data.inputs.data())));
}

TEST(TrainTest, Learns) {
  std::mt19937 rng(7);
  const DenseShape shape = ShapeOf({3, 32, 16, 1});
  Data data(3, 2048, &rng);
  for (int r = 0; r < 2048; ++r)
    data.targets[r] =
        std::sin(3 * data.inputs[3 * r]) * data.inputs[3 * r + 1] + std::abs(data.inputs[3 * r + 2]);
  TrainOptions options;
  options.learning_rate = 5e-3;
  options.dropout = 0.0;
  DenseTrainer trainer(shape, RandomFloats(ParameterCount(shape), &rng, 0.4f).data(), options);
  const double before = trainer.Evaluate(data.inputs.data(), data.targets.data(), 2048);
  for (int step = 0; step < 1500; ++step) {
    std::vector<std::uint32_t> rows(128);
    for (std::uint32_t& r : rows) r = rng() % 2048;
    trainer.Step(data.inputs.data(), data.targets.data(), rows.data(), 128);
  }
  EXPECT_LT(trainer.Evaluate(data.inputs.data(), data.targets.data(), 2048), 0.01 * before);
}

TEST(TrainTest, BrokenDataShows) {
  std::mt19937 rng(8);
  Data data(5, 64, &rng);
  data.inputs[12] = std::numeric_limits<float>::quiet_NaN();
  const DenseShape shape = ShapeOf({5, 30, 1});
  DenseTrainer trainer(shape, RandomFloats(ParameterCount(shape), &rng).data(), {});
  EXPECT_TRUE(std::isnan(trainer.Step(data.inputs.data(), data.targets.data(), FirstRows(64).data(), 64)));
}

TEST(TrainTest, RefusesBadOptionsAndBatches) {
  const DenseShape shape = ShapeOf({2, 3, 1});
  const std::vector<float> flat(ParameterCount(shape));
  const auto with = [](auto change) {
    TrainOptions options;
    change(options);
    return options;
  };
  for (const TrainOptions& options :
       {with([](TrainOptions& o) { o.learning_rate = 0; }),
        with([](TrainOptions& o) { o.learning_rate = NAN; }), with([](TrainOptions& o) { o.beta1 = 1; }),
        with([](TrainOptions& o) { o.beta2 = -0.1; }), with([](TrainOptions& o) { o.epsilon = 0; }),
        with([](TrainOptions& o) { o.dropout = 1; }), with([](TrainOptions& o) { o.max_rows = 0; }),
        with([](TrainOptions& o) { o.threads = 0; })})
    EXPECT_THROW(DenseTrainer(shape, flat.data(), options), std::invalid_argument);
  DenseTrainer trainer(shape, flat.data(), {});
  const std::vector<float> inputs(2), targets(1);
  const std::vector<std::uint32_t> rows(200);
  EXPECT_THROW(trainer.Step(inputs.data(), targets.data(), rows.data(), 0), std::invalid_argument);
  EXPECT_THROW(trainer.Step(inputs.data(), targets.data(), rows.data(), 129), std::invalid_argument);
  EXPECT_EQ(trainer.steps(), 0u);
  trainer.Step(inputs.data(), targets.data(), rows.data(), 128);
}

}  // namespace
}  // namespace ed3r::kernels
