#include "engine/core/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace ed3r {
namespace {

TEST(StreamTest, SameKeySameDraws) {
  Stream a(7, 3, Purpose::kCpu, 5);
  Stream b(7, 3, Purpose::kCpu, 5);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.Bits(), b.Bits());
}

TEST(StreamTest, EveryPartOfTheKeyCounts) {
  std::set<std::uint32_t> first;
  for (std::uint64_t seed : {7ULL, 8ULL, 7ULL + (1ULL << 32)})
    first.insert(Stream(seed, 3, Purpose::kCpu, 5).Bits());
  first.insert(Stream(7, 4, Purpose::kCpu, 5).Bits());
  first.insert(Stream(7, 3, Purpose::kBandwidth, 5).Bits());
  first.insert(Stream(7, 3, Purpose::kCpu, 6).Bits());
  EXPECT_EQ(first.size(), 6u);
}

// Known answer of Philox4x32-10 from the Random123 distribution: counter 0, key 0.
TEST(StreamTest, IsPhilox) {
  Stream zero(0, 0, static_cast<Purpose>(0), 0);
  EXPECT_EQ(zero.Bits(), 0x6627e8d5u);
  EXPECT_EQ(zero.Bits(), 0xe169c58du);
  EXPECT_EQ(zero.Bits(), 0xbc57ac4cu);
  EXPECT_EQ(zero.Bits(), 0x9b00dbd8u);
}

TEST(StreamTest, UniformAndNormalHaveTheirMoments) {
  Stream stream(1, 0, Purpose::kFrames);
  const int n = 200000;
  double uniform_sum = 0, normal_sum = 0, normal_square = 0;
  for (int i = 0; i < n; ++i) {
    const double u = stream.Uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    uniform_sum += u;
    const double z = stream.Normal();
    normal_sum += z;
    normal_square += z * z;
  }
  // Five standard errors.
  EXPECT_NEAR(uniform_sum / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(normal_sum / n, 0.0, 5 / std::sqrt(n));
  EXPECT_NEAR(normal_square / n, 1.0, 5 * std::sqrt(2.0 / n));
}

TEST(StreamTest, BelowIsUniform) {
  Stream stream(2, 0, Purpose::kCandidates);
  int counts[7] = {};
  const int n = 70000;
  for (int i = 0; i < n; ++i) ++counts[stream.Below(7)];
  for (int count : counts) EXPECT_NEAR(count, n / 7.0, 5 * std::sqrt(n / 7.0));
}

}  // namespace
}  // namespace ed3r
