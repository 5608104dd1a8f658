// From the 32-bit sums of one integer layer to the 8-bit inputs of the next (network.h has the formula).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ed3r::perception {

struct Requantization {
  float scale = 0.0f;        // input_scale weight_scale of the layer
  float leaky_slope = 1.0f;  // 1: no LeakyReLU
  // One per value of an output row (pixels x channels): the channels' values over and over, because one long loop
  // vectorises and a loop over 8 channels does not (6x slower).
  std::vector<float> biases;
  std::vector<std::int32_t> zero_point_sums;  // what the input's zero point added to the sums
  // Of the next layer's input.
  float inverse_scale = 0.0f;
  std::int32_t zero_point = 0;
  std::int32_t max = 0;
};

// One output row. Bit-identical on every CPU.
void RequantizeRow(const Requantization& r, const std::int32_t* sums, std::uint8_t* next);

// The real value of a single-channel layer's sum.
float Dequantized(const Requantization& r, std::int32_t sum);

}  // namespace ed3r::perception
