// The plainest form of what the kernels compute, straight from the flat parameters: one row, one neuron, one
// input at a time. The kernels must agree with it bit for bit.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "kernels/aligned_floats.h"
#include "kernels/dense_net.h"
#include "kernels/rfnn.h"

namespace ed3r::kernels {

inline DenseShape ShapeOf(const std::vector<int>& sizes) {
  return MakeDenseShape(sizes.data(), static_cast<int>(sizes.size()));
}

inline const std::vector<int> kRcSizes = {13, 128, 64, 64, 32, 1};
inline const std::vector<int> kRobotSizes = {11, 128, 64, 32, 1};

inline std::vector<SimdLevel> LevelsHere() {
  std::vector<SimdLevel> levels;
  for (SimdLevel level : {SimdLevel::kScalar, SimdLevel::kAvx2, SimdLevel::kAvx512})
    if (SimdLevelSupported(level)) levels.push_back(level);
  return levels;
}

inline std::vector<float> RandomFloats(std::size_t n, std::mt19937* rng, float scale = 1.0f) {
  std::uniform_real_distribution<float> draw(-scale, scale);
  std::vector<float> values(n);
  for (float& v : values) v = draw(*rng);
  return values;
}

inline std::uint32_t Bits(float v) {
  std::uint32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
}

inline std::vector<std::uint32_t> Bits(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (float v : values) bits.push_back(Bits(v));
  return bits;
}

// The network on one row of inputs.
inline float ReferenceValue(const DenseShape& shape, const std::vector<float>& flat, const float* inputs) {
  std::vector<float> h(inputs, inputs + shape.inputs());
  const float* w = flat.data();
  for (int l = 0; l < shape.layers; ++l) {
    const int in = shape.sizes[l], out = shape.sizes[l + 1];
    const float* b = w + static_cast<std::size_t>(in) * out;
    std::vector<float> next(out);
    for (int o = 0; o < out; ++o) {
      float z = b[o];
      for (int i = 0; i < in; ++i) z = std::fma(w[static_cast<std::size_t>(o) * in + i], h[i], z);
      next[o] = l + 1 == shape.layers || !(0.0f > z) ? z : 0.0f;
    }
    h = next;
    w = b + out;
  }
  return std::isnan(h[0]) ? std::numeric_limits<float>::quiet_NaN() : h[0];
}

// A network, and what a test needs to ask it.
struct TestNet {
  TestNet(const std::vector<int>& sizes, std::vector<float> flat_parameters)
      : shape(ShapeOf(sizes)),
        flat(std::move(flat_parameters)),
        packed(PackedFloats(shape)),
        workspace(RfnnWorkspaceFloats(shape)) {
    PackParameters(shape, flat.data(), packed.data());
  }
  TestNet(const std::vector<int>& sizes, std::mt19937* rng, float scale = 0.3f)
      : TestNet(sizes, RandomFloats(ParameterCount(ShapeOf(sizes)), rng, scale)) {}

  DenseNet net() const { return {shape, packed.data()}; }

  std::vector<float> ReferenceValues(const std::vector<float>& state, const std::vector<float>& actions,
                                     int n) const {
    const std::size_t n_action = shape.inputs() - state.size();
    std::vector<float> values;
    for (int c = 0; c < n; ++c) {
      std::vector<float> row = state;
      row.insert(row.end(), actions.begin() + c * n_action, actions.begin() + (c + 1) * n_action);
      values.push_back(ReferenceValue(shape, flat, row.data()));
    }
    return values;
  }

  DenseShape shape;
  std::vector<float> flat;
  AlignedFloats packed;
  mutable AlignedFloats workspace;
};

// First index of the largest value; a NaN loses to every number.
inline int ReferenceBest(const std::vector<float>& values) {
  if (values.empty()) return -1;
  int best = 0;
  for (int i = 1; i < static_cast<int>(values.size()); ++i)
    if (values[i] > values[best] || (std::isnan(values[best]) && !std::isnan(values[i]))) best = i;
  return best;
}

struct Way {
  const char* name;
  RfnnBest (*run)(const DenseNet&, const RfnnDecision&, float*, SimdLevel);
};
inline constexpr Way kWays[] = {{"chosen", RfnnArgmax},
                                {"across candidates", RfnnAcrossCandidates},
                                {"across neurons", RfnnAcrossNeurons}};

}  // namespace ed3r::kernels
