#include "engine/perception/vision/topology.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"

namespace ed3r::perception {
namespace {

// Table of CV models: 11 convolutional + 2 fully connected, 36.5 M parameters, 20.23 GFLOP.
TEST(Topology, TheFullSizeNetworkHasThePapersLayersParametersAndOperations) {
  const Topology full = FullSizeTopology();
  EXPECT_EQ(full.convolutions.size(), 11u);
  EXPECT_EQ(full.dense.size(), 2u);
  EXPECT_NEAR(static_cast<double>(ParameterCount(full)), 36.5e6, 0.005 * 36.5e6);
  EXPECT_NEAR(static_cast<double>(FlopCount(full)), 20.23e9, 0.005 * 20.23e9);
}

TEST(Topology, TheCompactNetworksHaveTheSameLayersAndAreSmall) {
  for (const Topology& compact : {CompactFullTopology(), CompactQuantizedTopology()}) {
    EXPECT_EQ(compact.convolutions.size(), 11u);
    EXPECT_EQ(compact.dense.size(), 2u);
    EXPECT_LT(MultiplyAdds(compact), 25'000'000);
  }
  EXPECT_EQ(CompactFullTopology().width_px, 192);
  EXPECT_EQ(CompactFullTopology().height_px, 108);
}

// 5.05 of 20.23 GFLOP; sides that are rounded up in the small layers, and what is fully connected, make ours 0.265.
TEST(Topology, QuantizedCostsTheShareOfFullThatThePaperPrints) {
  const double ours = static_cast<double>(FlopCount(CompactQuantizedTopology())) /
                      static_cast<double>(FlopCount(CompactFullTopology()));
  EXPECT_NEAR(ours, 5.05 / 20.23, 0.02);
}

// Counted by hand: 5 x 4 pixels, one convolution to 2 channels with stride 2 -> 3 x 2, then 12 inputs -> 1.
TEST(Topology, CountsOfASmallNetworkAreThoseCountedByHand) {
  const Topology small{
      .name = "small", .width_px = 5, .height_px = 4, .convolutions = {{2, 3, 2}}, .dense = {1}};
  const std::vector<LayerShape> layers = Layers(small);
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[0].out_width, 3);
  EXPECT_EQ(layers[0].out_height, 2);
  EXPECT_EQ(layers[1].Inputs(), 12);
  EXPECT_EQ(ParameterCount(small), (27 * 2 + 2) + (12 + 1));
  EXPECT_EQ(MultiplyAdds(small), 27 * 2 * 6 + 12);
  EXPECT_EQ(FlopCount(small), 2 * MultiplyAdds(small));
}

TEST(Topology, RefusesDesignsThatMakeNoSense) {
  Topology two_outputs = CompactQuantizedTopology();
  two_outputs.dense.back() = 2;
  EXPECT_THROW(Layers(two_outputs), UserError);
  Topology even_kernel = CompactQuantizedTopology();
  even_kernel.convolutions[3].kernel = 2;
  EXPECT_THROW(Layers(even_kernel), UserError);
  Topology no_pixels = CompactQuantizedTopology();
  no_pixels.width_px = 0;
  EXPECT_THROW(Layers(no_pixels), UserError);
}

}  // namespace
}  // namespace ed3r::perception
