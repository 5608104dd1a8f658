// The detectors' architecture (Table of CV models): convolutions, then fully connected layers, LeakyReLU after each but
// the last, whose single output is the logit of "fire or smoke in view".
//
// A convolution has a square odd kernel, zero padding of half a kernel and no dilation; a stride of 2 does what pooling
// would do. Counts: a multiply-add is one weight applied once; FLOP = 2 x multiply-adds, as the paper's Eq. 5 divides by
// floating-point operations per cycle, of which a fused multiply-add is two. Biases and LeakyReLU are not counted
// (0.1 % of the full-size network).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ed3r::perception {

struct ConvolutionDesign {
  int channels;  // out
  int kernel;    // odd
  int stride;
};

struct Topology {
  std::string name;
  int width_px = 0;
  int height_px = 0;
  int colours = 3;
  float leaky_slope = 0.1f;  // of LeakyReLU on the negative side
  std::vector<ConvolutionDesign> convolutions;
  std::vector<int> dense;  // outputs of the fully connected layers; the last is 1
};

// A layer with all its sizes. A fully connected layer is a convolution whose kernel is the whole input.
struct LayerShape {
  bool dense = false;
  int in_channels, in_height, in_width;
  int out_channels, out_height, out_width;
  int kernel_height, kernel_width, stride, padding;

  std::int64_t Weights() const {
    return std::int64_t{out_channels} * in_channels * kernel_height * kernel_width;
  }
  std::int64_t MultiplyAdds() const { return Weights() * out_height * out_width; }
  std::int64_t Inputs() const { return std::int64_t{in_channels} * in_height * in_width; }
  std::int64_t Outputs() const { return std::int64_t{out_channels} * out_height * out_width; }
};

// Throws UserError that starts with the name for a topology that makes no sense.
std::vector<LayerShape> Layers(const Topology& topology);

std::int64_t ParameterCount(const Topology& topology);  // weights and biases
std::int64_t MultiplyAdds(const Topology& topology);    // of one frame
std::int64_t FlopCount(const Topology& topology);       // 2 x multiply-adds

// What flies: 11 + 2 layers, the same for both networks. Quantized looks at frames of half the width and height, and
// so costs a quarter of Full, as the paper's does (5.05 of 20.23 GFLOP).
Topology CompactFullTopology();       // 192 x 108
Topology CompactQuantizedTopology();  // 96 x 54

// The paper's size: 11 + 2 layers at 224 x 224, 36.5 M parameters and 20.23 GFLOP, both within 0.5 %. The paper gives the
// totals, not the widths; these are ours.
Topology FullSizeTopology();

}  // namespace ed3r::perception
