// Internal: C = epilogue(init + A B), the loop below every layer that works across neurons.
//
// Included once by each level_*.cc, after it has defined
//   V::F            a vector of V::kLanes floats
//   V::Load Store Set1 Fma Relu, and V::Held, which keeps a loaded vector in its register
//   V::kGemmRows    rows of a tile; V::kGemmVectors accumulators that fit its registers
// Everything has internal linkage: code for one instruction set must not be the copy that the linker keeps
// for all of them.
#pragma once

#include <cstddef>

#include "kernels/dense_net.h"

namespace ed3r::kernels {
namespace {

constexpr int kParts = kDenseBlock / V::kLanes;  // vectors in a block of 16 columns

// Element strides let one loop serve the forward pass (A rows = samples), the input gradient and the weight
// gradient (A rows = inputs, k = samples).
struct Gemm {
  const float* a;
  std::size_t a_row, a_k;
  const float* b;
  std::size_t b_block, b_k;
  const float* init;  // null: zero
  std::size_t init_row, init_block;
  float* c;
  std::size_t c_row, c_block;
  int rows, blocks, k;
};

struct Plain {
  V::F operator()(V::F value, int /*row*/, int /*column*/) const { return value; }
};

struct Relu {
  V::F operator()(V::F value, int /*row*/, int /*column*/) const { return V::Relu(value); }
};

// R rows x N blocks held in registers over the whole of k: each sum runs in ascending k. Not inlined: inlined
// tiles share so many strides that GCC spills addresses in the inner loop (three rows: 0.94 us became 0.79).
template <int R, int N, class Epilogue>
__attribute__((noinline)) void GemmTile(const Gemm& g, int row, int block, const Epilogue& epilogue) {
  constexpr int kVectors = N * kParts;
  V::F acc[R][kVectors];
  const float* init = g.init ? g.init + row * g.init_row + block * g.init_block : nullptr;
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r)
#pragma GCC unroll 64
    for (int j = 0; j < kVectors; ++j)
      acc[r][j] = init ? V::Load(init + r * g.init_row + j / kParts * g.init_block + j % kParts * V::kLanes)
                       : V::Set1(0.0f);

  const float* a = g.a + row * g.a_row;
  const float* b = g.b + block * g.b_block;
  for (int k = 0; k < g.k; ++k, a += g.a_k, b += g.b_k) {
    V::F b_k[kVectors];
#pragma GCC unroll 64
    for (int j = 0; j < kVectors; ++j)
      b_k[j] = V::Held(V::Load(b + j / kParts * g.b_block + j % kParts * V::kLanes));
#pragma GCC unroll 16
    for (int r = 0; r < R; ++r) {
      const V::F a_rk = V::Set1(a[r * g.a_row]);
#pragma GCC unroll 64
      for (int j = 0; j < kVectors; ++j) acc[r][j] = V::Fma(a_rk, b_k[j], acc[r][j]);
    }
  }

  float* c = g.c + row * g.c_row + block * g.c_block;
#pragma GCC unroll 16
  for (int r = 0; r < R; ++r)
#pragma GCC unroll 64
    for (int j = 0; j < kVectors; ++j) {
      const int column = block * kDenseBlock + j * V::kLanes;
      V::Store(c + r * g.c_row + j / kParts * g.c_block + j % kParts * V::kLanes,
               epilogue(acc[r][j], row + r, column));
    }
}

// Widest tile of R rows that fits the registers: 4, 2 or 1 blocks.
template <int R>
constexpr int TileBlocks() {
  return R * kParts * 4 <= V::kGemmVectors ? 4 : R * kParts * 2 <= V::kGemmVectors ? 2 : 1;
}

template <int R, class Epilogue>
inline void GemmRows(const Gemm& g, int row, const Epilogue& epilogue) {
  constexpr int kBlocks = TileBlocks<R>();
  int block = 0;
  for (; block + kBlocks <= g.blocks; block += kBlocks) GemmTile<R, kBlocks>(g, row, block, epilogue);
  if constexpr (kBlocks == 4)
    for (; block + 2 <= g.blocks; block += 2) GemmTile<R, 2>(g, row, block, epilogue);
  if constexpr (kBlocks > 1)
    for (; block < g.blocks; ++block) GemmTile<R, 1>(g, row, block, epilogue);
}

template <int R, class Epilogue>
inline void GemmLastRows(const Gemm& g, int row, const Epilogue& epilogue) {
  if constexpr (R > 0) {
    if (g.rows - row == R)
      GemmRows<R>(g, row, epilogue);
    else
      GemmLastRows<R - 1>(g, row, epilogue);
  }
}

template <class Epilogue>
void RunGemm(const Gemm& g, const Epilogue& epilogue) {
  int row = 0;
  for (; row + V::kGemmRows <= g.rows; row += V::kGemmRows) GemmRows<V::kGemmRows>(g, row, epilogue);
  GemmLastRows<V::kGemmRows - 1>(g, row, epilogue);
}

}  // namespace
}  // namespace ed3r::kernels
