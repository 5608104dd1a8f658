// Coverage of the nominal 95 % interval of a paired difference (tests/claims/coverage_test.cc, PrintsTheTable;
// 1,000 synthetic studies each, 850 missions of skewed energy, mean 31 kJ; luck: standard deviation of a network's
// factor on its arm's energies; standard error of a share 0.7 points):
//
//   networks  luck   covered, %   missions alone would cover, %   half-width, kJ
//          2   0.0         99.3                         95.4            11.5
//          2   0.05        98.2                         71.9            20.2
//          2   0.2         95.8                         25.7            66.3
//          3   0.0         98.4                         93.7             4.3
//          3   0.05        96.6                         77.3             6.5
//          3   0.2         94.4                         33.3            19.8
//          5   0.0         98.4                         94.9             3.0
//          5   0.05        96.4                         85.0             3.9
//          5   0.2         94.5                         39.9            10.7
//         10   0.0         96.3                         94.5             2.5
//         10   0.05        95.2                         88.7             2.8
//         10   0.2         94.5                         51.5             6.4
#include "studies/statistics/resampling.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "studies/statistics/intervals.h"

namespace ed3r::statistics {
namespace {

constexpr std::uint64_t kSeed = 6;  // any; fixed, so that a report is the same every time
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kNormal95 = 1.959963984540054;

enum Level : std::uint32_t { kMissions = 0, kNetworks = 1 };

std::vector<double> Known(const std::vector<double>& values) {
  std::vector<double> known;
  for (const double value : values)
    if (std::isfinite(value)) known.push_back(value);
  if (known.size() < 2 || 2 * known.size() < values.size()) known.clear();
  return known;
}

double StandardDeviation(const std::vector<double>& values) {
  // Their mean would round.
  if (std::all_of(values.begin(), values.end(), [&](double x) { return x == values.front(); })) return 0;
  double mean = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

// Of the missions: infinite where their number is not told.
double DegreesOf(const Resampled& number) {
  return number.units == 0 ? std::numeric_limits<double>::infinity()
                           : static_cast<double>(number.units - number.strata);
}

// What the standard deviation of the resamples is too small by.
double CorrectionOf(const Resampled& number) {
  return number.units == 0 ? 1.0 : std::sqrt(static_cast<double>(number.units) / DegreesOf(number));
}

// The sign test's p-value, doubled: all of `count` fell on one side.
double SignP(double count) { return std::min(1.0, std::exp2(1.0 - count)); }

// The chance of a deviation this far above 0 or further, times two; `count` things were drawn.
double TwiceTail(double degrees, double deviation, double sd, double count) {
  if (sd == 0) return deviation > 0 ? SignP(count) : 1;
  const auto twice = [&](const auto& distribution) {
    return std::min(1.0, 2 * boost::math::cdf(boost::math::complement(distribution, deviation / sd)));
  };
  return std::isinf(degrees) ? twice(boost::math::normal()) : twice(boost::math::students_t(degrees));
}

}  // namespace

Resampler::Resampler(std::vector<int> group_of_unit, int groups)
    : units_(group_of_unit.size()), members_(static_cast<std::size_t>(groups)) {
  for (std::size_t unit = 0; unit < group_of_unit.size(); ++unit) {
    ED3R_CHECK(0 <= group_of_unit[unit] && group_of_unit[unit] < groups, "a unit belongs to a group");
    members_[static_cast<std::size_t>(group_of_unit[unit])].push_back(static_cast<int>(unit));
  }
}

void Resampler::DrawMissions(int resample, std::vector<int>& count_of_unit) const {
  count_of_unit.assign(units_, 0);
  Stream stream(kSeed, static_cast<std::uint32_t>(resample), Purpose::kBootstrap, kMissions);
  for (const std::vector<int>& members : members_)
    for (std::size_t i = 0; i < members.size(); ++i)
      ++count_of_unit[static_cast<std::size_t>(
          members[stream.Below(static_cast<std::uint32_t>(members.size()))])];
}

void Resampler::DrawNetworks(int resample, std::vector<int>& count_of_group) const {
  count_of_group.assign(members_.size(), 0);
  Stream stream(kSeed, static_cast<std::uint32_t>(resample), Purpose::kBootstrap, kNetworks);
  for (std::size_t i = 0; i < members_.size(); ++i)
    ++count_of_group[stream.Below(static_cast<std::uint32_t>(members_.size()))];
}

Uncertainty UncertaintyOf(const Resampled& number) {
  Uncertainty result{kNone, kNone, kNone, kNone};
  std::vector<double> missions = Known(number.missions);
  if (missions.empty() || !std::isfinite(number.value) || DegreesOf(number) < 1) return result;
  const double correction = CorrectionOf(number);
  result.sd_missions = correction * StandardDeviation(missions);
  std::sort(missions.begin(), missions.end());
  const auto percentile = [&](double share) {
    return missions[static_cast<std::size_t>(std::llround(share * static_cast<double>(missions.size() - 1)))];
  };
  const double widened = number.units == 0 ? 1.0 : correction * StudentT95(DegreesOf(number)) / kNormal95;
  result.lo = number.value + widened * (percentile(0.025) - number.value);
  result.hi = number.value + widened * (percentile(0.975) - number.value);
  const std::vector<double> networks = Known(number.networks);
  if (number.network_count < 2 || networks.empty()) return result;
  const double count = number.network_count;
  result.sd_networks = StandardDeviation(networks) * std::sqrt(count / (count - 1));
  const double half = StudentT95(count - 1) * result.sd_networks;
  result.lo = std::min(result.lo, number.value - half);
  result.hi = std::max(result.hi, number.value + half);
  return result;
}

Sides TestAgainst(const Resampled& number, const Uncertainty& uncertainty, double threshold) {
  if (std::isnan(uncertainty.sd_missions)) return {1, 1};
  const double deviation = number.value - threshold;
  const double many = std::numeric_limits<double>::infinity();
  const double units = number.units == 0 ? many : static_cast<double>(number.units);
  const auto tail = [&](double towards) {
    const double missions = TwiceTail(DegreesOf(number), towards, uncertainty.sd_missions, units);
    if (std::isnan(uncertainty.sd_networks)) return missions;
    // Networks that agree by accident say nothing that their missions do not.
    return std::max(missions, TwiceTail(number.network_count - 1, towards, uncertainty.sd_networks, many));
  };
  return {tail(deviation), tail(-deviation)};
}

}  // namespace ed3r::statistics
