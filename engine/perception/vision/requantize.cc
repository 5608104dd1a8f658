#include "engine/perception/vision/requantize.h"

namespace ed3r::perception {

void RequantizeRow(const Requantization& r, const std::int32_t* __restrict sums,
                   std::uint8_t* __restrict next) {
  // Adding and taking off 1.5 x 2^23 rounds half to even below 2^22 and, unlike nearbyint, vectorises everywhere.
  constexpr float kRound = 12582912.0f;
  const std::size_t values = r.biases.size();
  const float* __restrict biases = r.biases.data();
  const std::int32_t* __restrict zero_sums = r.zero_point_sums.data();
  const float scale = r.scale, slope = r.leaky_slope, inverse = r.inverse_scale;
  // Clamping to whole numbers before rounding is the same as after it.
  const auto low = static_cast<float>(-r.zero_point), high = static_cast<float>(r.max - r.zero_point);
  const std::int32_t zero_point = r.zero_point;
  for (std::size_t i = 0; i < values; ++i) {
    const float y = static_cast<float>(sums[i] - zero_sums[i]) * scale + biases[i];
    const float below = y * slope;
    float x = (y > below ? y : below) * inverse;  // LeakyReLU: the slope is in [0, 1]
    x = x > low ? x : low;
    x = x < high ? x : high;
    next[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>((x + kRound) - kRound) + zero_point);
  }
}

float Dequantized(const Requantization& r, std::int32_t sum) {
  return static_cast<float>(sum - r.zero_point_sums.front()) * r.scale + r.biases.front();
}

}  // namespace ed3r::perception
