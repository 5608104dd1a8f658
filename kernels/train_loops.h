// Internal: one training step, forward, backward and Adam. Included once by each level_*.cc after
// gemm_loops.h; see there. In addition to what stands there, V has
//   V::Mul Div Sqrt
//   V::FusedNegative(a, b, c)       c - a b, fused
//   V::WherePositive(h, x)          h > 0 ? x : 0
//   V::Dropout(x, row_key, neuron_keys, limit)   x, or 0 where DropoutDraws drops it
//   V::Transpose(from, to)          16 x 16 floats
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/dense_kernels.h"
#include "kernels/gemm_loops.h"
#include "kernels/train.h"

namespace ed3r::kernels {
namespace {

// relu, then inverted dropout.
struct DropoutRelu {
  const std::uint32_t* row_keys;
  const std::uint32_t* neuron_keys;
  std::int32_t limit;
  float scale;

  V::F operator()(V::F z, int row, int column) const {
    return V::Dropout(V::Mul(V::Relu(z), V::Set1(scale)), row_keys[row], neuron_keys + column, limit);
  }
};

// The derivative of both: an activation is positive exactly where it was neither cut off nor dropped.
struct DropoutReluGradient {
  const float* activations;
  std::size_t width;
  float scale;

  V::F operator()(V::F dx, int row, int column) const {
    return V::WherePositive(V::Load(activations + row * width + column), V::Mul(dx, V::Set1(scale)));
  }
};

// Where a block's activations and deltas lie in its scratch memory, and the widths of their rows.
struct TrainLayout {
  float* h[kMaxDenseLayers + 1];
  std::size_t width[kMaxDenseLayers + 1];
  float* delta[2];
};

inline TrainLayout LayOut(const TrainBlock& t) {
  TrainLayout at;
  float* next = t.scratch;
  std::size_t widest = 0;
  for (int l = 0; l <= t.shape->layers; ++l) {
    at.width[l] = PadToBlock(t.shape->sizes[l]);
    at.h[l] = next;
    next += at.width[l] * kTrainRows;
    if (at.width[l] > widest) widest = at.width[l];
  }
  at.delta[0] = next;
  at.delta[1] = next + widest * kTrainRows;
  return at;
}

inline void GatherRows(const TrainBlock& t, const TrainLayout& at) {
  const std::size_t inputs = t.shape->sizes[0];
  for (int r = 0; r < t.n; ++r)
    for (std::size_t i = 0; i < inputs; ++i) at.h[0][r * at.width[0] + i] = t.inputs[t.rows[r] * inputs + i];
}

inline void Forward(const TrainBlock& t, const TrainLayout& at) {
  const DenseShape& shape = *t.shape;
  DropoutRelu epilogue{t.dropout.row_keys + t.first_row, t.dropout.neuron_keys, t.dropout.limit,
                       t.dropout.scale};
  const float* base = t.packed;
  for (int l = 0; l < shape.layers; ++l) {
    const std::size_t stride = PackedBlockStride(shape, l);
    const int blocks = static_cast<int>(at.width[l + 1]) / kDenseBlock;
    const Gemm g{.a = at.h[l],
                 .a_row = at.width[l],
                 .a_k = 1,
                 .b = base + kDenseBlock,
                 .b_block = stride,
                 .b_k = kDenseBlock,
                 .init = base,
                 .init_row = 0,
                 .init_block = stride,
                 .c = at.h[l + 1],
                 .c_row = at.width[l + 1],
                 .c_block = kDenseBlock,
                 .rows = t.n,
                 .blocks = blocks,
                 .k = shape.sizes[l]};
    if (l + 1 == shape.layers) {
      RunGemm(g, Plain());
    } else {
      RunGemm(g, epilogue);
      epilogue.neuron_keys += at.width[l + 1];
    }
    base += stride * blocks;
  }
}

// delta = dL/dy; returns the sum of squared errors.
inline double OutputDelta(const TrainBlock& t, const TrainLayout& at, float* delta) {
  double squares = 0.0;
  const float* y = at.h[t.shape->layers];
  for (int r = 0; r < t.n; ++r) {
    const float error = y[r * kDenseBlock] - t.targets[t.rows[r]];
    for (int c = 0; c < kDenseBlock; ++c) delta[r * kDenseBlock + c] = 0.0f;
    delta[r * kDenseBlock] = t.error_factor * error;
    squares += static_cast<double>(error) * error;
  }
  return squares;
}

// dL/dW of the single output, across inputs: across outputs 15 of 16 lanes would be padding.
inline void OutputWeightGradient(const TrainBlock& t, const TrainLayout& at, int l, const float* delta,
                                 float* spare, float* gradient) {
  RunGemm({.a = delta,
           .a_row = 0,
           .a_k = kDenseBlock,
           .b = at.h[l],
           .b_block = kDenseBlock,
           .b_k = at.width[l],
           .init = nullptr,
           .init_row = 0,
           .init_block = 0,
           .c = spare,
           .c_row = 0,
           .c_block = kDenseBlock,
           .rows = 1,
           .blocks = static_cast<int>(at.width[l]) / kDenseBlock,
           .k = t.n},
          Plain());
  for (int i = 0; i < t.shape->sizes[l]; ++i) gradient[(i + 1) * kDenseBlock] = spare[i];
}

// dL/dW[i] = sum over the rows of h[i] delta, dL/db = sum of delta.
inline void WeightGradient(const TrainBlock& t, const TrainLayout& at, int l, const float* delta,
                           float* spare, float* gradient) {
  static constexpr float kOne = 1.0f;
  const std::size_t stride = PackedBlockStride(*t.shape, l);
  Gemm g{.a = at.h[l],
         .a_row = 1,
         .a_k = at.width[l],
         .b = delta,
         .b_block = kDenseBlock,
         .b_k = at.width[l + 1],
         .init = nullptr,
         .init_row = 0,
         .init_block = 0,
         .c = gradient + kDenseBlock,
         .c_row = kDenseBlock,
         .c_block = stride,
         .rows = t.shape->sizes[l],
         .blocks = static_cast<int>(at.width[l + 1]) / kDenseBlock,
         .k = t.n};
  if (l + 1 == t.shape->layers)
    OutputWeightGradient(t, at, l, delta, spare, gradient);
  else
    RunGemm(g, Plain());
  g.a = &kOne;
  g.a_row = g.a_k = 0;
  g.c = gradient;
  g.rows = 1;
  RunGemm(g, Plain());
}

// Delta of layer l's inputs, through the activation that made them.
inline void InputDelta(const TrainBlock& t, const TrainLayout& at, int l, const float* delta,
                       float* input_delta) {
  const std::size_t out = t.shape->sizes[l + 1];
  std::size_t offset = 0;
  for (int k = 1; k < l; ++k) offset += at.width[k] * t.shape->sizes[k + 1];
  RunGemm({.a = delta,
           .a_row = at.width[l + 1],
           .a_k = 1,
           .b = t.transposed + offset,
           .b_block = out * kDenseBlock,
           .b_k = kDenseBlock,
           .init = nullptr,
           .init_row = 0,
           .init_block = 0,
           .c = input_delta,
           .c_row = at.width[l],
           .c_block = kDenseBlock,
           .rows = t.n,
           .blocks = static_cast<int>(at.width[l]) / kDenseBlock,
           .k = static_cast<int>(out)},
          DropoutReluGradient{at.h[l], at.width[l], t.dropout.scale});
}

double BlockGradient(const TrainBlock& t) {
  const TrainLayout at = LayOut(t);
  GatherRows(t, at);
  Forward(t, at);
  int turn = 0;
  const double squares = OutputDelta(t, at, at.delta[turn]);
  float* gradient = t.gradient + PackedFloats(*t.shape);
  for (int l = t.shape->layers - 1; l >= 0; --l, turn ^= 1) {
    gradient -= PackedBlockStride(*t.shape, l) * (at.width[l + 1] / kDenseBlock);
    float* other = at.delta[turn ^ 1];
    WeightGradient(t, at, l, at.delta[turn], other, gradient);
    if (l > 0) InputDelta(t, at, l, at.delta[turn], other);
  }
  return squares;
}

// One row of 16 parameters; `at` is its offset in the packed form.
inline void AdamRow(const AdamState& s, std::size_t size, std::size_t at) {
  const AdamStep& k = s.step;
#pragma GCC unroll 16
  for (int part = 0; part < kParts; ++part) {
    const std::size_t i = at + part * V::kLanes;
    V::F g = V::Load(s.gradients + i);
    for (int b = 1; b < s.blocks; ++b) g = V::Add(g, V::Load(s.gradients + b * size + i));
    const V::F m = V::Fma(V::Set1(k.beta1), V::Load(s.m + i), V::Mul(V::Set1(k.one_minus_beta1), g));
    const V::F v =
        V::Fma(V::Set1(k.beta2), V::Load(s.v + i), V::Mul(V::Mul(V::Set1(k.one_minus_beta2), g), g));
    V::Store(s.m + i, m);
    V::Store(s.v + i, v);
    const V::F root = V::Fma(V::Sqrt(v), V::Set1(k.root_factor), V::Set1(k.epsilon));
    V::Store(s.packed + i, V::FusedNegative(V::Set1(k.rate), V::Div(m, root), V::Load(s.packed + i)));
  }
}

void AdamBlock(const AdamState& s, int layer, int output_block) {
  const DenseShape& shape = *s.shape;
  const std::size_t size = PackedFloats(shape);
  const int in = shape.sizes[layer], out = shape.sizes[layer + 1];
  const std::size_t base = PackedLayerOffset(shape, layer) + output_block * PackedBlockStride(shape, layer);
  for (int row = 0; row <= in; ++row) AdamRow(s, size, base + static_cast<std::size_t>(row) * kDenseBlock);
  if (layer == 0) return;  // no delta flows back to the inputs of the network

  const float* weights = s.packed + base + kDenseBlock;
  float* transposed = s.transposed + TransposedLayerOffset(shape, layer);
  const int first = output_block * kDenseBlock;
  const int outputs = out - first < kDenseBlock ? out - first : kDenseBlock;
  for (int i = 0; i < in; i += kDenseBlock) {
    const float* from = weights + static_cast<std::size_t>(i) * kDenseBlock;
    float* to = transposed + static_cast<std::size_t>(i / kDenseBlock * out + first) * kDenseBlock;
    if (outputs == kDenseBlock && i + kDenseBlock <= in) {
      V::Transpose(from, to);
      continue;
    }
    for (int o = 0; o < outputs; ++o)
      for (int r = 0; r < kDenseBlock && i + r < in; ++r) to[o * kDenseBlock + r] = from[r * kDenseBlock + o];
  }
}

}  // namespace
}  // namespace ed3r::kernels
