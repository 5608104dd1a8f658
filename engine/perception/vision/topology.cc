#include "engine/perception/vision/topology.h"

#include <fmt/format.h>

#include "engine/core/check.h"

namespace ed3r::perception {
namespace {

constexpr int kMaxSide_px = 4096;
constexpr int kMaxChannels = 65536;
constexpr std::int64_t kMaxValues = 1 << 27;  // between two layers

void Require(bool condition, const Topology& topology, const std::string& why) {
  if (!condition) throw UserError(fmt::format("{}: {}", topology.name, why));
}

void CheckDesign(const Topology& t) {
  Require(t.width_px >= 1 && t.width_px <= kMaxSide_px && t.height_px >= 1 && t.height_px <= kMaxSide_px, t,
          fmt::format("an input of {} x {} pixels is not in 1 .. {}", t.width_px, t.height_px, kMaxSide_px));
  Require(t.colours == 3, t, fmt::format("{} colour channels; it must be 3", t.colours));
  Require(t.leaky_slope >= 0.0f && t.leaky_slope < 1.0f, t,
          fmt::format("a LeakyReLU slope of {} is not in [0, 1)", t.leaky_slope));
  Require(!t.dense.empty() && t.dense.back() == 1, t, "the last layer must have one output");
  for (const int outputs : t.dense)
    Require(outputs >= 1 && outputs <= kMaxChannels, t, fmt::format("a layer of {} outputs", outputs));
  for (const ConvolutionDesign& c : t.convolutions)
    Require(
        c.channels >= 1 && c.channels <= kMaxChannels && c.kernel >= 1 && c.kernel <= 15 &&
            c.kernel % 2 == 1 && c.stride >= 1 && c.stride <= 8,
        t,
        fmt::format("a convolution with {} channels, kernel {}, stride {}", c.channels, c.kernel, c.stride));
}

Topology Compact(int width_px, int height_px) {
  return {.name = fmt::format("compact {}x{}", width_px, height_px),
          .width_px = width_px,
          .height_px = height_px,
          .convolutions = {{8, 3, 2},
                           {8, 3, 1},
                           {16, 3, 2},
                           {16, 3, 1},
                           {32, 3, 2},
                           {32, 3, 1},
                           {48, 3, 2},
                           {48, 3, 1},
                           {64, 3, 1},
                           {64, 3, 1},
                           {64, 3, 2}},
          .dense = {64, 1}};
}

}  // namespace

std::vector<LayerShape> Layers(const Topology& topology) {
  CheckDesign(topology);
  std::vector<LayerShape> layers;
  int channels = topology.colours, height = topology.height_px, width = topology.width_px;
  for (const ConvolutionDesign& c : topology.convolutions) {
    const int padding = c.kernel / 2;
    const auto size = [&](int side) { return (side + 2 * padding - c.kernel) / c.stride + 1; };
    layers.push_back({.dense = false,
                      .in_channels = channels,
                      .in_height = height,
                      .in_width = width,
                      .out_channels = c.channels,
                      .out_height = size(height),
                      .out_width = size(width),
                      .kernel_height = c.kernel,
                      .kernel_width = c.kernel,
                      .stride = c.stride,
                      .padding = padding});
    const LayerShape& made = layers.back();
    Require(std::int64_t{made.out_channels} * made.out_height * made.out_width <= kMaxValues, topology,
            fmt::format("a convolution that makes {} x {} x {} values", made.out_channels, made.out_height,
                        made.out_width));
    channels = c.channels;
    height = layers.back().out_height;
    width = layers.back().out_width;
  }
  for (const int outputs : topology.dense) {
    layers.push_back({.dense = true,
                      .in_channels = channels,
                      .in_height = height,
                      .in_width = width,
                      .out_channels = outputs,
                      .out_height = 1,
                      .out_width = 1,
                      .kernel_height = height,
                      .kernel_width = width,
                      .stride = 1,
                      .padding = 0});
    channels = outputs;
    height = width = 1;
  }
  return layers;
}

std::int64_t ParameterCount(const Topology& topology) {
  std::int64_t count = 0;
  for (const LayerShape& layer : Layers(topology)) count += layer.Weights() + layer.out_channels;
  return count;
}

std::int64_t MultiplyAdds(const Topology& topology) {
  std::int64_t count = 0;
  for (const LayerShape& layer : Layers(topology)) count += layer.MultiplyAdds();
  return count;
}

std::int64_t FlopCount(const Topology& topology) { return 2 * MultiplyAdds(topology); }

Topology CompactFullTopology() { return Compact(192, 108); }
Topology CompactQuantizedTopology() { return Compact(96, 54); }

Topology FullSizeTopology() {
  return {.name = "full size 224x224",
          .width_px = 224,
          .height_px = 224,
          .convolutions = {{64, 3, 2},
                           {64, 3, 1},
                           {160, 3, 1},
                           {160, 3, 2},
                           {288, 3, 1},
                           {288, 3, 1},
                           {288, 3, 2},
                           {512, 3, 1},
                           {512, 3, 1},
                           {512, 3, 2},
                           {512, 3, 2}},
          .dense = {1024, 1}};
}

}  // namespace ed3r::perception
