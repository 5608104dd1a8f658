#include "kernels/dense_net.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>

#include "tests/kernels/reference.h"

namespace ed3r::kernels {
namespace {

TEST(DenseNetTest, CountsOfThePapersNetworks) {
  EXPECT_EQ(ParameterCount(ShapeOf(kRcSizes)), 14u * 128 + 129 * 64 + 65 * 64 + 65 * 32 + 33);
  EXPECT_EQ(ParameterCount(ShapeOf(kRobotSizes)), 12u * 128 + 129 * 64 + 65 * 32 + 33);
  EXPECT_EQ(WidestLayer(ShapeOf(kRcSizes)), 128);
  EXPECT_EQ(WidestLayer(ShapeOf({33, 5, 1})), 48);
}

TEST(DenseNetTest, PackingIsReversible) {
  std::mt19937 rng(1);
  for (const std::vector<int>& sizes : {kRcSizes, kRobotSizes, {1, 1}, {3, 17, 5, 1}, {2, 16, 32, 1}}) {
    const DenseShape shape = ShapeOf(sizes);
    const std::vector<float> flat = RandomFloats(ParameterCount(shape), &rng);
    std::vector<float> packed(PackedFloats(shape), 9.0f), back(flat.size());
    PackParameters(shape, flat.data(), packed.data());
    UnpackParameters(shape, packed.data(), back.data());
    EXPECT_EQ(back, flat);
    std::size_t zeros = 0;
    for (float v : packed) zeros += v == 0.0f;
    EXPECT_EQ(zeros, packed.size() - flat.size());  // padding, and nothing else
  }
}

TEST(DenseNetTest, PackedFormIsBlocksOfSixteenOutputs) {
  // 2 inputs, 17 hidden, 1 output: weight (o, i) = 100 o + i, bias o = 100 o + 99.
  const DenseShape shape = ShapeOf({2, 17, 1});
  std::vector<float> flat;
  for (int o = 0; o < 17; ++o)
    for (int i = 0; i < 2; ++i) flat.push_back(100.0f * o + i);
  for (int o = 0; o < 17; ++o) flat.push_back(100.0f * o + 99);
  flat.resize(ParameterCount(shape), 5.0f);
  std::vector<float> packed(PackedFloats(shape));
  PackParameters(shape, flat.data(), packed.data());
  EXPECT_EQ(PackedBlockStride(shape, 0), 48u);
  EXPECT_EQ(packed[3], 399.0f);         // bias of output 3
  EXPECT_EQ(packed[16 + 3], 300.0f);    // its weight of input 0
  EXPECT_EQ(packed[32 + 3], 301.0f);    // its weight of input 1
  EXPECT_EQ(packed[48 + 16], 1600.0f);  // output 16 opens the second block
  EXPECT_EQ(packed[48 + 17], 0.0f);     // padding
  EXPECT_EQ(PackedLayerOffset(shape, 1), 96u);
}

TEST(DenseNetTest, RefusesImpossibleShapes) {
  for (const std::vector<int>& sizes : std::vector<std::vector<int>>{
           {5}, {5, 2}, {0, 1}, {5, -1, 1}, {5, 70000, 1}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 1}})
    EXPECT_THROW(ShapeOf(sizes), std::invalid_argument);
}

TEST(AlignedFloatsTest, IsAlignedAndZero) {
  AlignedFloats block(100);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.data()) % AlignedFloats::kAlignment, 0u);
  for (std::size_t i = 0; i < block.size(); ++i) EXPECT_EQ(block.data()[i], 0.0f);
  EXPECT_EQ(AlignedFloats().size(), 0u);
}

}  // namespace
}  // namespace ed3r::kernels
