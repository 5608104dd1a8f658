// 95 % confidence intervals for what a sample of missions says about an arm.
//
// A mission is the unit that is drawn independently; the timesteps within one are not (a mission that sees
// the fire keeps seeing it), so whatever is pooled over timesteps takes its spread from between missions.
// Missions of an arm are balanced over sites and base stations, which these intervals do not use: they err on
// the wide side. They hold for the networks that flew; they know nothing of other training seeds.
//
// All functions are pure and draw nothing: the same sample gives the same interval on every machine. Fewer
// than two missions give no interval. Lists that belong together have equal lengths (ED3R_CHECK).
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace ed3r::statistics {

// [lo, hi]; both NaN where the sample cannot give one.
struct Interval {
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();

  bool Exists() const { return !std::isnan(lo) && !std::isnan(hi); }
};

// The two-sided 95 % quantile of Student's t; degrees > 0.
double StudentT95(double degrees);

// The two-sided p-value of a value of Student's t; degrees > 0.
double StudentP(double t, double degrees);

// Mean of a sample: Student's t. Mission energies are skewed, with a lump at the battery's capacity, and t
// still does what the bootstrap does: over three synthetic arms of 850 missions it covered 94.5-96.0 %
// (percentile bootstrap 94.2-95.3, bootstrap-t 94.0-96.3). At 20 missions it covers 88-92 % (percentile
// 85-92); bootstrap-t reaches 91-97 there, with intervals 2.5-8 times as wide at 5 missions.
Interval MeanInterval(std::span<const double> sample);

// The p-value of "the mean of what was drawn from is 0" that goes with MeanInterval; NaN under two. A sample of one value
// throughout tells t nothing of the spread: then the sign test's, 2^(1 - n), or 1 where that value is 0.
double MeanP(std::span<const double> sample);

// Rate of a yes-or-no event, `events` out of `trials` independent missions: Wilson's score interval.
Interval RateInterval(std::int64_t events, std::int64_t trials);

// Ratio of two totals, sum(part) / sum(whole), e.g. energy per time: linearised (Taylor) variance of the
// ratio between missions, Student's t. Missions with whole = 0 carry no information and do not count.
Interval RatioInterval(std::span<const double> part, std::span<const double> whole);

// What the share counts: single timesteps, or whole missions weighted by their size.
enum class ShareUnit { kTimestep, kMission };

// Share sum(part) / sum(whole) with 0 <= part <= whole in every mission: Wilson's interval with the effective
// sample size p(1 - p) / v, v being the linearised variance between missions, and t instead of z. Unlike
// p +- t sqrt(v), which is [0, 0] for a share of 0 and covers 93 % where 24 of 850 missions failed, it stays
// inside [0, 1] and keeps its coverage at small shares. (Franco, Little, Louis and Slud, J. Survey Stat.
// Methodol. 2019, recommend it for proportions of clustered samples; the adjustment by t is Korn and
// Graubard's.)
// What no interval can know is the cost of failures that a sample happens not to hold: for wasted energy it
// covers 75 % where 3 failures are expected, 91 % at 6 and 94-96 % from 9 on.
// The effective size is at most the number of timesteps (kTimestep), or, where a mission counts whole or not
// at all (kMission), Kish's (sum w)^2 / sum w^2. The latter is also the size where every mission agrees.
Interval ShareInterval(std::span<const double> part, std::span<const double> whole, ShareUnit unit);

// Position, from 1, of the sample quantile percent/100 in a sorted sample of n > 0: the smallest value with
// at least that share of the sample at or below it.
std::int64_t QuantileRank(std::int64_t n, int percent);

// Quantile percent/100 (0 < percent < 100) of a sorted sample: two order statistics whose exact binomial
// coverage is at least 95 %, at most 2.5 % missed on each side, whatever the distribution. No interval where
// the sample is too small to have such a pair (fewer than 23 missions for the 85th percentile).
Interval QuantileInterval(std::span<const double> sorted, int percent);

}  // namespace ed3r::statistics
