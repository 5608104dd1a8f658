#include "kernels/dense_net.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace ed3r::kernels {
namespace {

// Calls visit(flat index, packed index) for every parameter.
template <class Visit>
void ForEachParameter(const DenseShape& shape, Visit&& visit) {
  std::size_t flat = 0;
  for (int layer = 0; layer < shape.layers; ++layer) {
    const int in = shape.sizes[layer], out = shape.sizes[layer + 1];
    const std::size_t base = PackedLayerOffset(shape, layer);
    const auto row = [&](int o) {  // of the biases; the weight of input i stands i + 1 rows below
      return base + o / kDenseBlock * PackedBlockStride(shape, layer) + o % kDenseBlock;
    };
    for (int o = 0; o < out; ++o)
      for (int i = 0; i < in; ++i) visit(flat++, row(o) + static_cast<std::size_t>(i + 1) * kDenseBlock);
    for (int o = 0; o < out; ++o) visit(flat++, row(o));
  }
}

}  // namespace

DenseShape MakeDenseShape(const int* sizes, int count) {
  if (count < 2 || count > kMaxDenseLayers + 1)
    throw std::invalid_argument("a dense network has 1 to " + std::to_string(kMaxDenseLayers) +
                                " layers, not " + std::to_string(count - 1));
  DenseShape shape;
  shape.layers = count - 1;
  for (int l = 0; l < count; ++l) {
    if (sizes[l] < 1 || sizes[l] > 65536)
      throw std::invalid_argument("a layer of a dense network has 1 to 65536 neurons, not " +
                                  std::to_string(sizes[l]));
    shape.sizes[l] = sizes[l];
  }
  if (sizes[count - 1] != 1)
    throw std::invalid_argument("a regression network has 1 output, not " + std::to_string(sizes[count - 1]));
  return shape;
}

int WidestLayer(const DenseShape& shape) {
  int widest = 0;
  for (int l = 0; l <= shape.layers; ++l) widest = std::max(widest, PadToBlock(shape.sizes[l]));
  return widest;
}

std::size_t ParameterCount(const DenseShape& shape) {
  std::size_t count = 0;
  for (int l = 0; l < shape.layers; ++l)
    count += static_cast<std::size_t>(shape.sizes[l] + 1) * shape.sizes[l + 1];
  return count;
}

std::size_t PackedLayerOffset(const DenseShape& shape, int layer) {
  std::size_t offset = 0;
  for (int l = 0; l < layer; ++l)
    offset += static_cast<std::size_t>(shape.sizes[l] + 1) * PadToBlock(shape.sizes[l + 1]);
  return offset;
}

std::size_t PackedFloats(const DenseShape& shape) { return PackedLayerOffset(shape, shape.layers); }

void PackParameters(const DenseShape& shape, const float* flat, float* packed) {
  std::fill_n(packed, PackedFloats(shape), 0.0f);
  ForEachParameter(shape, [&](std::size_t f, std::size_t p) { packed[p] = flat[f]; });
}

void UnpackParameters(const DenseShape& shape, const float* packed, float* flat) {
  ForEachParameter(shape, [&](std::size_t f, std::size_t p) { flat[f] = packed[p]; });
}

}  // namespace ed3r::kernels
