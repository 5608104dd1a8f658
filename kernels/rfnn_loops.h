// Internal: inference of one decision, across candidates and across neurons. Included once by each level_*.cc
// after gemm_loops.h; see there.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/dense_kernels.h"
#include "kernels/gemm_loops.h"

namespace ed3r::kernels {
namespace {

// The block that works across candidates, held in registers while the weights are broadcast: output neurons x
// vectors of candidates. 12 sums, 3 inputs and 1 weight are the 16 registers of AVX2. AVX-512 has 32, but on
// Zen 4 (share of the FMA peak at 1000 candidates): 4 x 3 0.96, 16 x 1 0.94, 8 x 2 0.93, 8 x 3 0.90.
constexpr int kTileOutputs = 4, kTileVectors = 3;
constexpr int kTile = kTileVectors * V::kLanes;  // candidates
static_assert(kTile <= kMaxTile && kDenseBlock % kTileOutputs == 0);

inline float* AlignWorkspace(float* p) {
  return reinterpret_cast<float*>((reinterpret_cast<std::uintptr_t>(p) + 63) & ~std::uintptr_t{63});
}

// Running arg-max. NaN never replaces anything, anything but NaN replaces NaN; ties keep the lowest index.
class ArgMax {
 public:
  explicit ArgMax(const RfnnDecision& decision) : values_(decision.values) {
    best_.index = decision.n > 0 ? 0 : -1;
    best_.value = __builtin_nanf("");
  }

  void Add(int index, float value) {
    const bool is_nan = value != value;
    if (values_) values_[index] = is_nan ? __builtin_nanf("") : value;
    if (!is_nan && !(best_.value >= value)) best_ = {index, value};
  }

  RfnnBest best() const { return best_; }

 private:
  RfnnBest best_;
  float* values_;
};

// Layer 1 up to the end of the state, before the activation: part[o] = b[o] + sum over the state.
inline void StatePart(const DenseNet& net, const RfnnDecision& d, float* part) {
  const std::size_t stride = PackedBlockStride(net.shape, 0);
  RunGemm({.a = d.state,
           .a_row = 0,
           .a_k = 1,
           .b = net.packed + kDenseBlock,
           .b_block = stride,
           .b_k = kDenseBlock,
           .init = net.packed,
           .init_row = 0,
           .init_block = stride,
           .c = part,
           .c_row = 0,
           .c_block = kDenseBlock,
           .rows = 1,
           .blocks = PadToBlock(net.shape.sizes[1]) / kDenseBlock,
           .k = d.n_state},
          Plain());
}

// One layer's inputs to a tile of candidates.
struct TileLayer {
  const float* init;       // starting values, init_block floats from one block of 16 outputs to the next
  std::size_t init_block;  //
  const float* weights;    // row of the first input in the first block
  std::size_t block;       // floats from one block to the next
  const float* x;          // in rows of C vectors
  int in, out;
};

// acc[o][c] = init[o] + sum_i w[i][o] x[i][c]
template <int C>
inline void TileBlock(const TileLayer& layer, int first_output, V::F (&acc)[kTileOutputs][C]) {
  const int block = first_output / kDenseBlock, lane = first_output % kDenseBlock;
  const float* init = layer.init + block * layer.init_block + lane;
  const float* w = layer.weights + block * layer.block + lane;
  const float* x = layer.x;
#pragma GCC unroll 16
  for (int o = 0; o < kTileOutputs; ++o)
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) acc[o][c] = V::Set1(init[o]);
  for (int i = 0; i < layer.in; ++i, w += kDenseBlock, x += C * V::kLanes) {
    V::F x_i[C];
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) x_i[c] = V::Load(x + c * V::kLanes);
#pragma GCC unroll 16
    for (int o = 0; o < kTileOutputs; ++o) {
      const V::F w_oi = V::Set1(w[o]);
#pragma GCC unroll 16
      for (int c = 0; c < C; ++c) acc[o][c] = V::Fma(w_oi, x_i[c], acc[o][c]);
    }
  }
}

// A hidden layer whose activations go to memory.
template <int C>
inline void HiddenLayer(const TileLayer& layer, float* y) {
  for (int first = 0; first < layer.out; first += kTileOutputs) {
    V::F acc[kTileOutputs][C];
    TileBlock<C>(layer, first, acc);
#pragma GCC unroll 16
    for (int o = 0; o < kTileOutputs; ++o)
#pragma GCC unroll 16
      for (int c = 0; c < C; ++c) V::Store(y + ((first + o) * C + c) * V::kLanes, V::Relu(acc[o][c]));
  }
}

// The last hidden layer: its activations stay in registers and go straight into the output's sum.
template <int C>
inline void LastHiddenLayer(const TileLayer& layer, const float* output_weights, V::F (&y)[C]) {
  for (int first = 0; first < layer.out; first += kTileOutputs) {
    V::F acc[kTileOutputs][C];
    TileBlock<C>(layer, first, acc);
    const int outputs = layer.out - first;
#pragma GCC unroll 16
    for (int o = 0; o < kTileOutputs; ++o) {
      if (o >= outputs) break;  // padding of the block
      const V::F w = V::Set1(output_weights[(first + o) * kDenseBlock]);
#pragma GCC unroll 16
      for (int c = 0; c < C; ++c) y[c] = V::Fma(w, V::Relu(acc[o][c]), y[c]);
    }
  }
}

// The whole network on C vectors of candidates. x: the action inputs, rows of C vectors. values: C vectors.
template <int C>
void TileValues(const DenseNet& net, int n_state, const float* state_part, const float* x, float* spare0,
                float* spare1, float* values) {
  const DenseShape& shape = net.shape;
  const int last = shape.layers - 1;
  TileLayer layer{.init = state_part,
                  .init_block = kDenseBlock,
                  .weights = net.packed + (1 + n_state) * kDenseBlock,
                  .block = PackedBlockStride(shape, 0),
                  .x = x,
                  .in = shape.sizes[0] - n_state,
                  .out = shape.sizes[1]};
  V::F y[C];
  const float* base = net.packed;
  for (int l = 0; l < last - 1; ++l) {
    float* activations = l % 2 ? spare1 : spare0;
    HiddenLayer<C>(layer, activations);
    base += PackedBlockStride(shape, l) * (PadToBlock(shape.sizes[l + 1]) / kDenseBlock);
    const std::size_t block = PackedBlockStride(shape, l + 1);
    layer = {base, block, base + kDenseBlock, block, activations, shape.sizes[l + 1], shape.sizes[l + 2]};
  }
  if (last == 0) {  // no hidden layer: the output is linear in the action
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) y[c] = V::Set1(state_part[0]);
    for (int i = 0; i < layer.in; ++i)
#pragma GCC unroll 16
      for (int c = 0; c < C; ++c)
        y[c] = V::Fma(V::Set1(layer.weights[i * kDenseBlock]), V::Load(x + (i * C + c) * V::kLanes), y[c]);
  } else {
    base += PackedBlockStride(shape, last - 1) * (PadToBlock(shape.sizes[last]) / kDenseBlock);
#pragma GCC unroll 16
    for (int c = 0; c < C; ++c) y[c] = V::Set1(base[0]);
    LastHiddenLayer<C>(layer, base + kDenseBlock, y);
  }
#pragma GCC unroll 16
  for (int c = 0; c < C; ++c) V::Store(values + c * V::kLanes, y[c]);
}

// Candidates [first, first + count) in C vectors; lanes beyond count are zero and ignored.
template <int C>
inline void AddTile(const DenseNet& net, const RfnnDecision& d, int first, int count, const float* state_part,
                    float* x, float* spare0, float* spare1, ArgMax* best) {
  const int n_action = net.shape.sizes[0] - d.n_state;
  const float* rows = d.actions + static_cast<std::size_t>(first) * n_action;
  for (int i = 0; i < n_action; ++i)
    for (int c = 0; c < C * V::kLanes; ++c)
      x[i * C * V::kLanes + c] = c < count ? rows[static_cast<std::size_t>(c) * n_action + i] : 0.0f;
  alignas(64) float values[C * V::kLanes];
  TileValues<C>(net, d.n_state, state_part, x, spare0, spare1, values);
  for (int c = 0; c < count; ++c) best->Add(first + c, values[c]);
}

RfnnBest AcrossCandidates(const DenseNet& net, const RfnnDecision& d, float* workspace) {
  ArgMax best(d);
  if (d.n <= 0) return best.best();
  const std::size_t widest = WidestLayer(net.shape);
  float* state_part = AlignWorkspace(workspace);
  float* x = state_part + widest;
  float* spare0 = x + widest * kTile;
  float* spare1 = spare0 + widest * kTile;
  StatePart(net, d, state_part);
  for (int first = 0; first < d.n; first += kTile) {
    const int left = d.n - first;
    if (left > 2 * V::kLanes)
      AddTile<kTileVectors>(net, d, first, left < kTile ? left : kTile, state_part, x, spare0, spare1, &best);
    else if (left > V::kLanes)
      AddTile<2>(net, d, first, left, state_part, x, spare0, spare1, &best);
    else
      AddTile<1>(net, d, first, left, state_part, x, spare0, spare1, &best);
  }
  return best.best();
}

// Rows [first, first + count), count <= kRfnnFew, in lanes of output neurons.
inline void AddRows(const DenseNet& net, const RfnnDecision& d, int first, int count, const float* state_part,
                    float* spare0, float* spare1, ArgMax* best) {
  const DenseShape& shape = net.shape;
  const std::size_t widest = WidestLayer(shape);
  const int n_action = shape.sizes[0] - d.n_state;
  std::size_t stride = PackedBlockStride(shape, 0);
  Gemm g{.a = d.actions + static_cast<std::size_t>(first) * n_action,
         .a_row = static_cast<std::size_t>(n_action),
         .a_k = 1,
         .b = net.packed + (1 + d.n_state) * kDenseBlock,
         .b_block = stride,
         .b_k = kDenseBlock,
         .init = state_part,
         .init_row = 0,
         .init_block = kDenseBlock,
         .c = spare0,
         .c_row = widest,
         .c_block = kDenseBlock,
         .rows = count,
         .blocks = PadToBlock(shape.sizes[1]) / kDenseBlock,
         .k = n_action};
  const float* base = net.packed;
  for (int l = 0; l < shape.layers - 1; ++l) {
    RunGemm(g, Relu());
    base += stride * g.blocks;
    stride = PackedBlockStride(shape, l + 1);
    g.a = g.c;
    g.a_row = widest;
    g.b = base + kDenseBlock;
    g.init = base;
    g.b_block = g.init_block = stride;
    g.c = g.c == spare0 ? spare1 : spare0;
    g.blocks = PadToBlock(shape.sizes[l + 2]) / kDenseBlock;
    g.k = shape.sizes[l + 1];
  }
  RunGemm(g, Plain());
  for (int r = 0; r < count; ++r) best->Add(first + r, g.c[r * widest]);
}

RfnnBest AcrossNeurons(const DenseNet& net, const RfnnDecision& d, float* workspace) {
  ArgMax best(d);
  if (d.n <= 0) return best.best();
  const std::size_t widest = WidestLayer(net.shape);
  float* state_part = AlignWorkspace(workspace);
  float* spare0 = state_part + widest;
  float* spare1 = spare0 + widest * kRfnnFew;
  StatePart(net, d, state_part);
  for (int first = 0; first < d.n; first += kRfnnFew) {
    const int left = d.n - first;
    AddRows(net, d, first, left < kRfnnFew ? left : kRfnnFew, state_part, spare0, spare1, &best);
  }
  return best.best();
}

}  // namespace
}  // namespace ed3r::kernels
