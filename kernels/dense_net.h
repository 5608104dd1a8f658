// A dense network of ReLU layers with one linear output, and how its parameters lie in memory.
//
//   h_0 = x,   h_{l+1}[o] = relu(b_l[o] + sum_i W_l[o][i] h_l[i]),   y = the last layer without relu
//
// relu(z) = (0 > z ? 0 : z): a NaN goes through, so that a broken input or weight shows in the output.
//
// Two forms of the parameters:
//   flat    the exchange form (model files, initial weights): layer by layer W_l, row-major outputs x inputs,
//           then b_l. ParameterCount(shape) floats.
//   packed  the form that the kernels read, the same for every SIMD level and for inference and training:
//   layer
//           by layer, per block of 16 outputs one row of 16 biases and then one row of 16 weights per input.
//           Missing outputs of the last block are zero. PackedFloats(shape) floats; 64-byte alignment is not
//           required, but is faster.
#pragma once

#include <cstddef>

namespace ed3r::kernels {

inline constexpr int kMaxDenseLayers = 8;
inline constexpr int kDenseBlock = 16;  // outputs per packed block

// sizes[0] inputs, sizes[1 .. layers-1] hidden neurons, sizes[layers] = 1 output.
struct DenseShape {
  int layers = 0;
  int sizes[kMaxDenseLayers + 1] = {};

  int inputs() const { return sizes[0]; }
};

// A shape of `count` sizes, e.g. {13, 128, 64, 64, 32, 1}. Throws std::invalid_argument unless there are 2 to
// kMaxDenseLayers + 1 positive sizes of at most 65536 and the last is 1.
DenseShape MakeDenseShape(const int* sizes, int count);

// `size` rounded up to whole blocks.
inline constexpr int PadToBlock(int size) { return (size + kDenseBlock - 1) / kDenseBlock * kDenseBlock; }

// Padded width of the widest layer, inputs included.
int WidestLayer(const DenseShape& shape);

std::size_t ParameterCount(const DenseShape& shape);
std::size_t PackedFloats(const DenseShape& shape);

// Offset of layer l (0-based) in the packed form, and floats from one of its blocks to the next.
std::size_t PackedLayerOffset(const DenseShape& shape, int layer);
inline std::size_t PackedBlockStride(const DenseShape& shape, int layer) {
  return static_cast<std::size_t>(shape.sizes[layer] + 1) * kDenseBlock;
}

void PackParameters(const DenseShape& shape, const float* flat, float* packed);
void UnpackParameters(const DenseShape& shape, const float* packed, float* flat);

// A network ready for inference; does not own its parameters.
struct DenseNet {
  DenseShape shape;
  const float* packed = nullptr;
};

}  // namespace ed3r::kernels
