#include "kernels/rfnn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "kernels/dense_kernels.h"
#include "tests/kernels/reference.h"

namespace ed3r::kernels {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Every level and way of working gives the reference's values and choice.
void ExpectAllAgree(const TestNet& net, const std::vector<float>& state, const std::vector<float>& actions,
                    int n) {
  const std::vector<float> expected = net.ReferenceValues(state, actions, n);
  const int best = ReferenceBest(expected);
  for (SimdLevel level : LevelsHere())
    for (const Way& way : kWays) {
      SCOPED_TRACE(std::string(SimdLevelName(level)) + ", " + way.name + ", n " + std::to_string(n));
      std::vector<float> values(n, -7.0f);
      const RfnnDecision decision{state.data(), static_cast<int>(state.size()), actions.data(), n,
                                  values.data()};
      const RfnnBest got = way.run(net.net(), decision, net.workspace.data(), level);
      EXPECT_EQ(Bits(values), Bits(expected));
      EXPECT_EQ(got.index, best);
      EXPECT_EQ(Bits(got.value), Bits(best < 0 ? kNan : expected[best]));
    }
}

TEST(RfnnTest, AgreesWithReferenceAtEveryCount) {
  std::mt19937 rng(1);
  const TestNet rc(kRcSizes, &rng), robot(kRobotSizes, &rng);
  for (int n : {0, 1, 3, 15, 16, 17, 999, 1000, 1001})
    ExpectAllAgree(rc, RandomFloats(8, &rng), RandomFloats(n * 5, &rng), n);
  for (int n : {0, 1, 2, 3, 7, 8, 9, 15, 16, 17, 32, 33, 47, 48, 49})
    ExpectAllAgree(robot, RandomFloats(9, &rng), RandomFloats(n * 2, &rng), n);
}

TEST(RfnnTest, AgreesAtEveryAlignment) {
  std::mt19937 rng(2);
  const TestNet net(kRcSizes, &rng);
  const std::vector<float> state = RandomFloats(8, &rng), actions = RandomFloats(1001 * 5, &rng);
  const std::vector<float> expected = net.ReferenceValues(state, actions, 1001);
  const std::size_t packed = PackedFloats(net.shape), scratch = RfnnWorkspaceFloats(net.shape);
  for (int offset = 0; offset < 17; ++offset) {
    AlignedFloats s(8 + offset), a(1001 * 5 + offset), w(packed + offset), work(scratch + offset),
        out(1001 + offset);
    std::copy(state.begin(), state.end(), s.data() + offset);
    std::copy(actions.begin(), actions.end(), a.data() + offset);
    std::copy_n(net.packed.data(), packed, w.data() + offset);
    for (SimdLevel level : LevelsHere())
      for (int n : {1, 3, 15, 16, 17, 999, 1000, 1001}) {
        if (level == SimdLevel::kScalar && (offset != 1 || n > 100)) continue;  // no vectors, no alignment
        for (const Way& way : kWays) {
          way.run({net.shape, w.data() + offset},
                  {s.data() + offset, 8, a.data() + offset, n, out.data() + offset}, work.data() + offset,
                  level);
          ASSERT_EQ(std::memcmp(out.data() + offset, expected.data(), n * sizeof(float)), 0)
              << SimdLevelName(level) << ", " << way.name << ", n " << n << ", offset " << offset;
        }
      }
  }
}

TEST(RfnnTest, WritesNothingBeyondItsBuffers) {
  std::mt19937 rng(3);
  for (const std::vector<int>& sizes : {kRcSizes, kRobotSizes, {3, 5, 1}, {7, 1}, {200, 16, 1}}) {
    const TestNet net(sizes, &rng);
    const std::size_t scratch = RfnnWorkspaceFloats(net.shape);
    for (SimdLevel level : LevelsHere())
      for (const Way& way : kWays)
        for (int n : {1, 16, 17, 50}) {
          std::vector<float> work(scratch + 1, 1.0f), values(n + 1, 2.0f);
          const std::vector<float> actions = RandomFloats(n * sizes[0], &rng);
          way.run(net.net(), {nullptr, 0, actions.data(), n, values.data()}, work.data(), level);
          EXPECT_EQ(work[scratch], 1.0f);
          EXPECT_EQ(values[n], 2.0f);
        }
  }
}

TEST(RfnnTest, AnyShape) {
  std::mt19937 rng(4);
  for (const std::vector<int>& sizes : std::vector<std::vector<int>>{{1, 1},
                                                                     {5, 1},
                                                                     {1, 1, 1},
                                                                     {3, 7, 1},
                                                                     {40, 16, 1},
                                                                     {13, 17, 33, 1},
                                                                     {6, 129, 1},
                                                                     {9, 48, 31, 15, 8, 1},
                                                                     {4, 5, 6, 7, 8, 9, 10, 11, 1}}) {
    const TestNet net(sizes, &rng, 0.6f);
    for (int n_state : {0, sizes[0] / 2, sizes[0]})
      for (int n : {1, 3, 8, 20, 61})
        ExpectAllAgree(net, RandomFloats(n_state, &rng), RandomFloats(n * (sizes[0] - n_state), &rng), n);
  }
}

TEST(RfnnTest, ValueDoesNotDependOnWhereTheStateEnds) {
  std::mt19937 rng(5);
  const TestNet net(kRcSizes, &rng);
  const std::vector<float> inputs = RandomFloats(13, &rng);
  const float expected = ReferenceValue(net.shape, net.flat, inputs.data());
  for (SimdLevel level : LevelsHere())
    for (int n_state = 0; n_state <= 13; ++n_state) {
      const RfnnBest best =
          RfnnArgmax(net.net(), {inputs.data(), n_state, inputs.data() + n_state, 1, nullptr},
                     net.workspace.data(), level);
      EXPECT_EQ(Bits(best.value), Bits(expected)) << SimdLevelName(level) << ", state of " << n_state;
    }
}

TEST(RfnnTest, ValuesOfRows) {
  std::mt19937 rng(6);
  const TestNet net(kRobotSizes, &rng);
  const std::vector<float> inputs = RandomFloats(100 * 11, &rng);
  std::vector<float> values(100);
  for (SimdLevel level : LevelsHere()) {
    RfnnValues(net.net(), inputs.data(), 100, values.data(), net.workspace.data(), level);
    EXPECT_EQ(Bits(values), Bits(net.ReferenceValues({}, inputs, 100)));
  }
}

// On a CPU with FMA the scalar level uses its instruction; without, the C library. Both are the scalar twin.
TEST(RfnnTest, ScalarTwinOfTheCLibraryAgrees) {
  std::mt19937 rng(11);
  for (const std::vector<int>& sizes : {kRcSizes, kRobotSizes}) {
    const TestNet net(sizes, &rng);
    const std::vector<float> inputs = RandomFloats(60 * sizes[0], &rng);
    const std::vector<float> expected = net.ReferenceValues({}, inputs, 60);
    for (auto run : {ScalarKernels().across_candidates, ScalarKernels().across_neurons}) {
      std::vector<float> values(60);
      const RfnnBest best =
          run(net.net(), {nullptr, 0, inputs.data(), 60, values.data()}, net.workspace.data());
      EXPECT_EQ(Bits(values), Bits(expected));
      EXPECT_EQ(best.index, ReferenceBest(expected));
    }
  }
}

// y = relu(x) - relu(-x): the value is the input, so that a test can ask for any of them. -0 comes out as +0.
TestNet Identity() { return TestNet({1, 2, 1}, {1, -1, 0, 0, 1, -1, 0}); }

TEST(RfnnTest, TiesGoToTheLowestIndex) {
  const TestNet net = Identity();
  for (int n : {2, 3, 16, 17, 48, 49, 100, 1000})
    for (int first : {0, 1, n / 2, n - 2}) {
      std::vector<float> actions(n, 1.0f);
      for (int second = first + 1; second < n; second += 5) {
        actions[first] = actions[second] = 2.0f;
        ExpectAllAgree(net, {}, actions, n);
        EXPECT_EQ(ReferenceBest(actions), first);
        actions[second] = 1.0f;
      }
    }
  ExpectAllAgree(net, {}, std::vector<float>(100, -3.0f), 100);
  const TestNet linear({1, 1}, {1.0f, -0.0f});  // keeps the sign of zero
  ExpectAllAgree(linear, {}, {-0.0f, 0.0f, -0.0f}, 3);
  ExpectAllAgree(linear, {}, {0.0f, -0.0f, 0.0f}, 3);
}

TEST(RfnnTest, NanNeverWins) {
  const TestNet linear({1, 1}, {1.0f, 0.0f});
  ExpectAllAgree(linear, {}, {kNan, -kInf}, 2);
  ExpectAllAgree(linear, {}, {-kInf, kNan, -kInf}, 3);
  ExpectAllAgree(linear, {}, {kNan, kNan, 1.0f, kInf, kInf, kNan}, 6);
  for (SimdLevel level : LevelsHere())
    for (int n : {1, 2, 20, 100}) {
      const std::vector<float> actions(n, -kNan);
      std::vector<float> values(n);
      const RfnnBest best = RfnnArgmax(linear.net(), {nullptr, 0, actions.data(), n, values.data()},
                                       linear.workspace.data(), level);
      EXPECT_EQ(best.index, 0);
      EXPECT_EQ(Bits(best.value), Bits(kNan));
      EXPECT_EQ(Bits(values), std::vector<std::uint32_t>(n, Bits(kNan)));
    }
}

TEST(RfnnTest, NanInAWeightReachesEveryValue) {
  std::mt19937 rng(7);
  std::vector<float> flat = RandomFloats(ParameterCount(ShapeOf(kRcSizes)), &rng);
  flat[3] = kNan;
  const TestNet net(kRcSizes, flat);
  const std::vector<float> state = RandomFloats(8, &rng), actions = RandomFloats(100 * 5, &rng);
  const RfnnBest best =
      RfnnArgmax(net.net(), {state.data(), 8, actions.data(), 100, nullptr}, net.workspace.data());
  EXPECT_EQ(best.index, 0);
  EXPECT_TRUE(std::isnan(best.value));
}

TEST(RfnnTest, SpecialNumbersAgree) {
  std::mt19937 rng(8);
  const float specials[] = {kInf,  -kInf,  kNan,    -kNan,   0.0f, -0.0f, std::numeric_limits<float>::max(),
                            1e30f, 1e-42f, -1e-45f, 1.2e-38f};
  std::uniform_int_distribution<std::size_t> pick(0, std::size(specials) - 1);
  for (int round = 0; round < 60; ++round) {
    std::vector<int> sizes = round % 2 ? std::vector<int>{4, 19, 6, 1} : kRobotSizes;
    TestNet net(sizes, &rng);
    std::vector<float> flat = net.flat, state = RandomFloats(2, &rng);
    if (round % 3 == 0) flat[rng() % flat.size()] = specials[pick(rng)];
    if (round % 5 == 0) state[0] = specials[pick(rng)];
    std::vector<float> actions = RandomFloats(37 * (sizes[0] - 2), &rng);
    for (int k = 0; k < 12; ++k) actions[rng() % actions.size()] = specials[pick(rng)];
    ExpectAllAgree(TestNet(sizes, flat), state, actions, 37);
  }
}

TEST(RfnnTest, DenormalsAreKept) {
  std::mt19937 rng(9);
  const TestNet net({4, 20, 1}, &rng, 1e-20f);
  const std::vector<float> actions = RandomFloats(50 * 4, &rng, 1e-19f);
  const std::vector<float> values = net.ReferenceValues({}, actions, 50);
  ExpectAllAgree(net, {}, actions, 50);
  const TestNet tiny({1, 1}, {1.0f, 0.0f});
  ExpectAllAgree(tiny, {}, {1e-45f, 2e-45f, 1e-42f, -1e-44f}, 4);
  EXPECT_EQ(ReferenceBest(tiny.ReferenceValues({}, {1e-45f, 2e-45f, 1e-42f, -1e-44f}, 4)), 2);
}

// A million decisions, most of them on a small network because the scalar twin is slow.
TEST(RfnnTest, AMillionRandomDecisionsAgreeBetweenLevels) {
  std::mt19937 rng(10);
  struct Part {
    std::vector<int> sizes;
    int n_state, max_n, decisions;
  };
  const std::vector<SimdLevel> levels = LevelsHere();
  long total = 0;
  for (const Part& part : std::vector<Part>{{kRcSizes, 8, 1000, 30},
                                            {kRcSizes, 8, 60, 970},
                                            {kRobotSizes, 9, 3, 50000},
                                            {{7, 20, 9, 1}, 4, 3, 900000},
                                            {{5, 16, 1}, 2, 40, 49000}}) {
    TestNet net(part.sizes, &rng, 0.5f);
    const int n_action = part.sizes[0] - part.n_state;
    const std::vector<float> pool = RandomFloats(8192 + part.max_n * n_action, &rng, 2.0f);
    std::vector<std::vector<float>> values(levels.size(), std::vector<float>(part.max_n));
    for (int k = 0; k < part.decisions; ++k, ++total) {
      const int n = 1 + static_cast<int>(rng() % part.max_n);
      RfnnDecision decision{pool.data() + rng() % 8192, part.n_state, pool.data() + rng() % 8192, n, nullptr};
      RfnnBest first;
      for (std::size_t l = 0; l < levels.size(); ++l) {
        decision.values = values[l].data();
        const RfnnBest best = RfnnArgmax(net.net(), decision, net.workspace.data(), levels[l]);
        if (l == 0) first = best;
        ASSERT_EQ(best.index, first.index) << SimdLevelName(levels[l]) << ", decision " << total;
        ASSERT_EQ(Bits(best.value), Bits(first.value)) << SimdLevelName(levels[l]) << ", decision " << total;
        ASSERT_EQ(std::memcmp(values[l].data(), values[0].data(), n * sizeof(float)), 0)
            << SimdLevelName(levels[l]) << ", decision " << total;
      }
    }
  }
  EXPECT_EQ(total, 1000000);
}

}  // namespace
}  // namespace ed3r::kernels
