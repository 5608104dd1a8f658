// A trained detector: architecture, weights, the scales of its integer twin, calibration and where it came from.
// Plain data; share it read-only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/perception/vision/topology.h"

namespace ed3r::perception {

struct LayerWeights {
  std::vector<float> weights;  // out channel, in channel, row, column
  std::vector<float> biases;   // out channel
};

// Post-training quantisation of one layer, per tensor:
//   x = input_scale (q_x - input_zero_point),  q_x in 0 .. input_max        w = weight_scale q_w,  |q_w| <= WeightLimit
struct LayerQuantization {
  float input_scale = 0.0f;
  std::int32_t input_zero_point = 0;
  std::int32_t input_max = 0;
  float weight_scale = 0.0f;
};

// AVX2 adds neighbouring u8 x s8 products in 16 bits and saturates. With this limit on |q_w| two products always fit,
// so that the sums are exact integers on every CPU: 64 for pixels of 0 .. 255, 127 for activations of 0 .. 127.
constexpr std::int32_t WeightLimit(std::int32_t input_max) {
  const std::int32_t limit = 32767 / (2 * input_max);
  return limit < 127 ? limit : 127;
}

// confidence = 1 / (1 + exp(-(logit / temperature + offset)))
struct Calibration {
  double temperature = 1.0;
  double offset = 0.0;
};

struct DetectorModel {
  Topology topology;
  // The network sees (byte - pixel_offset) pixel_scale.
  std::int32_t pixel_offset = 128;
  float pixel_scale = 1.0f / 64.0f;
  std::vector<LayerWeights> layers;
  std::vector<LayerQuantization> quantization;  // one per layer, or empty: no integer twin
  Calibration full;
  Calibration quantized;
  std::string provenance;  // JSON: data hash, training seed, script hash, scores
};

// The weights as integers: round half to even of weight / weight_scale, within the limit.
std::vector<std::int8_t> QuantizedWeights(const LayerWeights& layer, const LayerQuantization& quantization);

double Confidence(double logit, const Calibration& calibration);

// Weights drawn from a seeded stream (He scaling) and quantisation scales that cover what such a network makes, for
// tests and benchmarks of the arithmetic: it has learnt nothing.
DetectorModel RandomDetectorModel(const Topology& topology, std::uint64_t seed);

}  // namespace ed3r::perception
