#include "engine/perception/vision/network.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "tests/vision/reference_network.h"

namespace ed3r::perception {
namespace {

using test::NoiseFrames;

std::span<const std::uint8_t> Frame(const std::vector<std::uint8_t>& rgb, std::size_t frames, std::size_t f) {
  const std::size_t size = rgb.size() / frames;
  return std::span(rgb).subspan(f * size, size);
}

std::vector<float> Logits(Network& network, const std::vector<std::uint8_t>& rgb, std::size_t frames) {
  std::vector<float> logits(frames);
  network.Logits(rgb, logits);
  return logits;
}

// Odd sizes, a 5 x 5 kernel, channel counts off every vector width, and weights at their limits.
Topology Awkward() {
  return {.name = "awkward",
          .width_px = 23,
          .height_px = 17,
          .leaky_slope = 0.2f,
          .convolutions = {{5, 5, 2}, {13, 3, 1}, {9, 1, 1}, {24, 3, 2}},
          .dense = {7, 1}};
}

TEST(FloatNetwork, AgreesWithPlainLoops) {
  for (const Topology& topology : {CompactQuantizedTopology(), Awkward()}) {
    const DetectorModel model = RandomDetectorModel(topology, 11);
    const std::vector<std::uint8_t> rgb = test::NoiseFrames(topology, 3, 5);
    const std::vector<float> logits = Logits(*MakeFloatNetwork(model, 3), rgb, 3);
    for (std::size_t f = 0; f < 3; ++f) {
      const double expected = test::ReferenceFloatLogit(model, Frame(rgb, 3, f));
      EXPECT_NEAR(logits[f], expected, 1e-4 * std::max(1.0, std::abs(expected))) << topology.name << f;
    }
    EXPECT_NE(logits[0], logits[1]);
  }
}

TEST(IntegerNetwork, EqualsExactIntegerArithmetic) {
  for (const Topology& topology : {CompactQuantizedTopology(), Awkward()}) {
    const DetectorModel model = RandomDetectorModel(topology, 12);
    const std::vector<std::uint8_t> rgb = test::NoiseFrames(topology, 3, 6);
    const std::vector<float> logits = Logits(*MakeIntegerNetwork(model, 3), rgb, 3);
    for (std::size_t f = 0; f < 3; ++f)
      EXPECT_EQ(logits[f], test::ReferenceIntegerLogit(model, Frame(rgb, 3, f))) << topology.name << f;
    EXPECT_NE(logits[0], logits[1]);
  }
}

// White frames and all weights at the limit of one sign: the largest pair sums that can occur. Where 16 bits
// saturated, the sums would be too small.
TEST(IntegerNetwork, TheLargestProductsDoNotSaturate) {
  const Topology topology = Awkward();
  for (const float sign : {1.0f, -1.0f}) {
    DetectorModel model = RandomDetectorModel(topology, 13);
    for (std::size_t l = 0; l < model.layers.size(); ++l) {
      const LayerQuantization& q = model.quantization[l];
      const float largest = q.weight_scale * static_cast<float>(WeightLimit(q.input_max));
      std::fill(model.layers[l].weights.begin(), model.layers[l].weights.end(), sign * largest);
      std::fill(model.layers[l].biases.begin(), model.layers[l].biases.end(), sign < 0 ? 1e6f : 0.0f);
    }
    model.layers.back().biases[0] = 0.0f;
    const std::vector<std::uint8_t> white(static_cast<std::size_t>(Layers(topology).front().Inputs()), 255);
    EXPECT_EQ(Logits(*MakeIntegerNetwork(model, 1), white, 1)[0], test::ReferenceIntegerLogit(model, white));
  }
}

TEST(Networks, AFrameDoesNotDependOnItsNeighboursOrTheBatch) {
  const DetectorModel model = RandomDetectorModel(CompactQuantizedTopology(), 14);
  const std::vector<std::uint8_t> rgb = test::NoiseFrames(model.topology, 7, 7);
  for (const auto& make : {MakeFloatNetwork, MakeIntegerNetwork}) {
    const std::unique_ptr<Network> network = make(model, 3);  // 7 = 3 + 3 + 1
    const std::vector<float> all = Logits(*network, rgb, 7);
    for (std::size_t f = 0; f < 7; ++f) {
      float alone = 0.0f;
      network->Logits(Frame(rgb, 7, f), std::span(&alone, 1));
      EXPECT_EQ(alone, all[f]) << f;
    }
    EXPECT_EQ(Logits(*make(model, 7), rgb, 7), all);
  }
}

TEST(Networks, SameBitsOnOneThreadAndManyAndNoThreadIsStarted) {
  const DetectorModel model = RandomDetectorModel(CompactQuantizedTopology(), 15);
  const std::vector<std::uint8_t> rgb = test::NoiseFrames(model.topology, 5, 8);
  omp_set_dynamic(0);
  for (const auto& make : {MakeFloatNetwork, MakeIntegerNetwork}) {
    const std::vector<float> expected = Logits(*make(model, 5), rgb, 5);
    std::vector<std::vector<float>> found(4);
    int threads = 0;
#pragma omp parallel num_threads(4)
    {
#pragma omp single
      threads = omp_get_num_threads();
      const int before = omp_get_max_threads();
      found[static_cast<std::size_t>(omp_get_thread_num())] = Logits(*make(model, 5), rgb, 5);
      EXPECT_EQ(omp_get_max_threads(), before);
    }
    ASSERT_EQ(threads, 4);
    for (const std::vector<float>& logits : found) EXPECT_EQ(logits, expected);

    // Made where OpenMP would give oneDNN three threads.
    omp_set_num_threads(3);
    const std::unique_ptr<Network> network = make(model, 5);
    EXPECT_EQ(Logits(*network, rgb, 5), expected);
    EXPECT_EQ(omp_get_max_threads(), 3);
  }
}

// The paper's size through the same code: it can be built and run, and both arithmetics see the same network.
TEST(Networks, TheFullSizeNetworkRunsOnce) {
  const DetectorModel model = RandomDetectorModel(FullSizeTopology(), 16);
  const std::vector<std::uint8_t> rgb = test::NoiseFrames(model.topology, 1, 9);
  const float full = Logits(*MakeFloatNetwork(model, 1), rgb, 1)[0];
  EXPECT_TRUE(std::isfinite(full));
  EXPECT_NE(full, 0.0f);
  EXPECT_TRUE(std::isfinite(Logits(*MakeIntegerNetwork(model, 1), rgb, 1)[0]));
}

}  // namespace
}  // namespace ed3r::perception
