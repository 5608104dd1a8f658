#include "engine/core/random.h"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>

namespace ed3r {

Stream::Stream(std::uint64_t seed, std::uint32_t scenario, Purpose purpose, std::uint32_t timestep)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, timestep, scenario, static_cast<std::uint32_t>(purpose)} {}

void Stream::Refill() {
  const r123::Philox4x32::ctr_type counter = {{counter_[0], counter_[1], counter_[2], counter_[3]}};
  const r123::Philox4x32::key_type key = {{key_[0], key_[1]}};
  const auto block = r123::Philox4x32()(counter, key);
  for (int i = 0; i < 4; ++i) block_[i] = block[i];
  ++counter_[0];
  used_ = 0;
}

std::uint32_t Stream::Bits() {
  if (used_ == 4) Refill();
  return block_[used_++];
}

double Stream::Uniform() {
  const std::uint64_t high = Bits() >> 5;  // 27 bits
  const std::uint64_t low = Bits() >> 6;   // 26 bits
  return static_cast<double>((high << 26) | low) * 0x1.0p-53;
}

double Stream::Uniform(double low, double high) { return low + (high - low) * Uniform(); }

std::uint32_t Stream::Below(std::uint32_t bound) {
  // Lemire's multiply-shift with rejection of the biased remainder.
  std::uint64_t product = static_cast<std::uint64_t>(Bits()) * bound;
  if (static_cast<std::uint32_t>(product) < bound) {
    const std::uint32_t threshold = -bound % bound;
    while (static_cast<std::uint32_t>(product) < threshold)
      product = static_cast<std::uint64_t>(Bits()) * bound;
  }
  return static_cast<std::uint32_t>(product >> 32);
}

double Stream::Normal() {
  if (has_spare_normal_) {
    has_spare_normal_ = false;
    return spare_normal_;
  }
  // Box-Muller; 1 - u lies in (0, 1], so the logarithm is finite.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
  const double angle = 2.0 * std::numbers::pi * Uniform();
  spare_normal_ = radius * std::sin(angle);
  has_spare_normal_ = true;
  return radius * std::cos(angle);
}

}  // namespace ed3r
