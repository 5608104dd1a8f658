#include "engine/perception/render/develop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "engine/core/check.h"

namespace ed3r::perception {
namespace {

constexpr PixelGrid kGrid{128, 96, 4};

RadiancePlanes Even(float red, float green, float blue) {
  RadiancePlanes planes(kGrid.Pixels());
  for (std::size_t i = 0; i < kGrid.Pixels(); ++i) planes.Set(i, {red, green, blue});
  return planes;
}

std::vector<std::uint8_t> Developed(const RadiancePlanes& planes, const Shot& shot) {
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(kGrid.width_px) * kGrid.height_px * 3);
  Develop(planes, kGrid, shot, rgb);
  return rgb;
}

int Encoded(double x) { return static_cast<int>(255.0 * std::sqrt(x * (1.0 + x / 9.0) / (1.0 + x)) + 0.5); }

TEST(Develop, FollowsTheToneCurveInRedGreenBlueOrder) {
  const auto rgb = Developed(Even(0.1f, 0.4f, 1.5f), {});
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    ASSERT_EQ(rgb[i], Encoded(0.1));
    ASSERT_EQ(rgb[i + 1], Encoded(0.4));
    ASSERT_EQ(rgb[i + 2], Encoded(1.5));
  }
}

TEST(Develop, SaturatesInsteadOfWrapping) {
  const auto rgb = Developed(Even(0.0f, 1e4f, 50.0f), {.noise = 40.0f, .noise_key = 7});
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    ASSERT_LT(rgb[i], 160);
    ASSERT_EQ(rgb[i + 1], 255);
  }
}

TEST(Develop, NoiseHasTheAskedDeviationAndNoMean) {
  for (const float deviation : {2.0f, 8.0f}) {
    const auto rgb = Developed(Even(0.4f, 0.4f, 0.4f), {.noise = deviation, .noise_key = 99});
    double sum = 0, squares = 0;
    for (const std::uint8_t level : rgb) {
      const double off = level - 255.0 * std::sqrt(0.4 * (1.0 + 0.4 / 9.0) / 1.4);
      sum += off;
      squares += off * off;
    }
    const double count = static_cast<double>(rgb.size());
    // 36,864 draws: the mean's standard error is deviation / 192; rounding adds a variance of 1/12.
    EXPECT_NEAR(sum / count, 0.0, 4.0 * deviation / 192.0);
    EXPECT_NEAR(std::sqrt(squares / count), std::sqrt(deviation * deviation + 1.0 / 12.0), 0.03 * deviation);
  }
}

TEST(Develop, NoiseOfNeighboursAndFramesIsUnrelated) {
  const auto first = Developed(Even(0.4f, 0.4f, 0.4f), {.noise = 8.0f, .noise_key = 1});
  const auto second = Developed(Even(0.4f, 0.4f, 0.4f), {.noise = 8.0f, .noise_key = 2});
  const auto correlation = [](const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
                              std::size_t lag) {
    const double mean = std::accumulate(a.begin(), a.end(), 0.0) / static_cast<double>(a.size());
    double product = 0, square = 0;
    for (std::size_t i = 0; i + lag < a.size(); ++i) {
      product += (a[i] - mean) * (b[i + lag] - mean);
      square += (a[i] - mean) * (a[i] - mean);
    }
    return product / square;
  };
  const std::size_t row = static_cast<std::size_t>(kGrid.width_px) * 3;
  for (const std::size_t lag : {std::size_t{1}, std::size_t{3}, row, row + 3})
    EXPECT_NEAR(correlation(first, first, lag), 0.0, 0.03) << "lag " << lag;
  EXPECT_NEAR(correlation(first, second, 0), 0.0, 0.03);
  EXPECT_NEAR(correlation(first, second, row), 0.0, 0.03);
}

TEST(Develop, ShiftsByWholeAndPartPixels) {
  // Radiance that grows to the right, 0.001 a column: a shift of 1.25 px adds 0.00125 everywhere.
  RadiancePlanes planes(kGrid.Pixels());
  for (int row = 0; row < kGrid.Rows(); ++row)
    for (int column = 0; column < kGrid.Columns(); ++column)
      planes.Set(static_cast<std::size_t>(row) * kGrid.Columns() + column, Colour::Constant(0.004f * column));
  const auto rgb = Developed(planes, {.right_px = 1.25f, .down_px = -2.5f});
  for (int x = 0; x < kGrid.width_px; ++x)
    EXPECT_EQ(rgb[3 * x], Encoded(0.004 * (x + kGrid.margin_px + 1.25)));
}

TEST(Develop, RefusesAShiftBeyondTheMarginAndAWrongSize) {
  const RadiancePlanes planes = Even(0.1f, 0.1f, 0.1f);
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(kGrid.width_px) * kGrid.height_px * 3);
  EXPECT_NO_THROW(Develop(planes, kGrid, {.right_px = -4.0f}, rgb));
  EXPECT_THROW(Develop(planes, kGrid, {.right_px = 4.5f}, rgb), InternalError);
  EXPECT_THROW(Develop(planes, kGrid, {.down_px = -4.1f}, rgb), InternalError);
  rgb.pop_back();
  EXPECT_THROW(Develop(planes, kGrid, {}, rgb), InternalError);
}

}  // namespace
}  // namespace ed3r::perception
