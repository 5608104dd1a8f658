#include "studies/statistics/intervals.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <numeric>

#include "engine/core/check.h"

namespace ed3r::statistics {
namespace {

constexpr double kTail = 0.025;
constexpr double kNormal95 = 1.959963984540054;

// A ratio of totals and the variance of its linearisation.
struct Ratio {
  std::int64_t missions = 0;  // with whole > 0
  double value = 0;
  double variance = 0;
  double whole_sum = 0;
  double whole_squares = 0;
};

Ratio Linearise(std::span<const double> part, std::span<const double> whole) {
  ED3R_CHECK(part.size() == whole.size(), "every part needs its whole");
  Ratio ratio;
  double part_sum = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    ED3R_CHECK(whole[i] >= 0, "a whole is a size");
    if (whole[i] == 0) continue;
    ++ratio.missions;
    part_sum += part[i];
    ratio.whole_sum += whole[i];
    ratio.whole_squares += whole[i] * whole[i];
  }
  if (ratio.missions < 2) return ratio;
  ratio.value = part_sum / ratio.whole_sum;
  double residuals = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (whole[i] == 0) continue;
    const double residual = part[i] - ratio.value * whole[i];
    residuals += residual * residual;
  }
  const double n = static_cast<double>(ratio.missions);
  ratio.variance = n / (n - 1) * residuals / (ratio.whole_sum * ratio.whole_sum);
  return ratio;
}

struct MeanAndError {
  double mean, standard_error;
};

// Of a sample of at least two.
MeanAndError MeanOf(std::span<const double> sample) {
  const double n = static_cast<double>(sample.size());
  const double mean = std::accumulate(sample.begin(), sample.end(), 0.0) / n;
  double squares = 0;
  for (const double x : sample) squares += (x - mean) * (x - mean);
  return {mean, std::sqrt(squares / (n - 1) / n)};
}

// Wilson's interval of a proportion seen in `size` trials, which need not be whole.
Interval Wilson(double proportion, double size, double quantile) {
  const double q2 = quantile * quantile;
  const double shrink = 1 + q2 / size;
  const double centre = (proportion + q2 / (2 * size)) / shrink;
  const double half =
      quantile / shrink * std::sqrt(proportion * (1 - proportion) / size + q2 / (4 * size * size));
  // At 0 and 1 the bound is exact in theory; rounding may put it a hair inside or outside.
  return {proportion <= 0 ? 0 : std::max(0.0, centre - half),
          proportion >= 1 ? 1 : std::min(1.0, centre + half)};
}

}  // namespace

double StudentT95(double degrees) {
  ED3R_CHECK(degrees > 0, "Student's t needs a degree of freedom");
  return boost::math::quantile(boost::math::complement(boost::math::students_t(degrees), kTail));
}

double StudentP(double t, double degrees) {
  ED3R_CHECK(degrees > 0, "Student's t needs a degree of freedom");
  return 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(degrees), std::abs(t)));
}

Interval MeanInterval(std::span<const double> sample) {
  if (sample.size() < 2) return {};
  const auto [mean, error] = MeanOf(sample);
  const double half = StudentT95(static_cast<double>(sample.size() - 1)) * error;
  return {mean - half, mean + half};
}

double MeanP(std::span<const double> sample) {
  if (sample.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  if (std::all_of(sample.begin(), sample.end(), [&](double x) { return x == sample.front(); }))
    return sample.front() == 0 ? 1 : std::exp2(1 - static_cast<double>(sample.size()));
  const auto [mean, error] = MeanOf(sample);
  return StudentP(mean / error, static_cast<double>(sample.size() - 1));
}

Interval RateInterval(std::int64_t events, std::int64_t trials) {
  ED3R_CHECK(0 <= events && events <= trials, "events are among the trials");
  if (trials < 2) return {};
  const double n = static_cast<double>(trials);
  return Wilson(static_cast<double>(events) / n, n, kNormal95);
}

Interval RatioInterval(std::span<const double> part, std::span<const double> whole) {
  const Ratio ratio = Linearise(part, whole);
  if (ratio.missions < 2) return {};
  const double half = StudentT95(static_cast<double>(ratio.missions - 1)) * std::sqrt(ratio.variance);
  return {ratio.value - half, ratio.value + half};
}

Interval ShareInterval(std::span<const double> part, std::span<const double> whole, ShareUnit unit) {
  for (std::size_t i = 0; i < std::min(part.size(), whole.size()); ++i)
    ED3R_CHECK(0 <= part[i] && part[i] <= whole[i], "a part is within its whole");
  const Ratio ratio = Linearise(part, whole);
  if (ratio.missions < 2) return {};
  const double kish = ratio.whole_sum * ratio.whole_sum / ratio.whole_squares;
  const double p = std::clamp(ratio.value, 0.0, 1.0);
  const double spread = p * (1 - p);
  double size = kish;
  if (spread > 0) {
    const double most = unit == ShareUnit::kTimestep ? ratio.whole_sum : kish;
    size = spread > most * ratio.variance ? most : spread / ratio.variance;
  }
  return Wilson(p, size, StudentT95(static_cast<double>(ratio.missions - 1)));
}

std::int64_t QuantileRank(std::int64_t n, int percent) {
  ED3R_CHECK(n > 0 && 0 < percent && percent < 100, "a quantile strictly within a sample");
  return (n * percent + 99) / 100;
}

Interval QuantileInterval(std::span<const double> sorted, int percent) {
  ED3R_CHECK(std::is_sorted(sorted.begin(), sorted.end()), "order statistics need order");
  const auto n = static_cast<std::int64_t>(sorted.size());
  if (n < 2) return {};
  const std::int64_t rank = QuantileRank(n, percent);
  // Values below the quantile are Binomial(n, percent/100): the l-th value exceeds it when fewer than l are.
  const boost::math::binomial below(static_cast<double>(n), percent / 100.0);
  std::int64_t lower = rank;
  while (lower > 0 && boost::math::cdf(below, static_cast<double>(lower - 1)) > kTail) --lower;
  std::int64_t upper = rank + 1;
  while (upper <= n &&
         boost::math::cdf(boost::math::complement(below, static_cast<double>(upper - 1))) > kTail)
    ++upper;
  if (lower == 0 || upper > n) return {};
  return {sorted[lower - 1], sorted[upper - 1]};
}

}  // namespace ed3r::statistics
