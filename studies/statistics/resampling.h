// Chance at two levels: which networks training happened to give, and which missions they happened to fly.
//
// The unit is a scenario: all arms meet the same ones, so a resample draws scenarios, not missions, and a
// difference between arms keeps its pairing (common random numbers). Every scenario belongs to the network
// (training seed) that flew it, in all arms alike.
//
// Two sets of resamples (Davison and Hinkley, Bootstrap Methods, 1997, 3.8: resampling both levels at once
// counts the chance between missions twice):
//   missions   within each network, as many scenarios as it has, with replacement: the networks at hand
//   networks   as many networks as there are, with replacement, each with all of its scenarios: this holds the
//              luck of training and, through the differing scenarios, the luck of missions too
//
// With few missions the first is too narrow likewise: n missions in G networks spread by the divisor n - G, and their
// standard deviation is used with Student's t of n - G degrees. Where that is 0 nothing is known.
//
// With few networks the second is too narrow twice over: it spreads by the divisor G instead of G - 1, and
// takes the spread of five numbers for known. Its standard deviation is scaled by sqrt(G / (G - 1)) and used
// with Student's t of G - 1 degrees. And five networks can agree by accident, so an interval is never narrower
// than that over missions alone. This holds its level whatever the luck of training, and errs on the wide side
// where there is none; resampling.cc has the measured coverage.
//
// Draws come from Stream(kBootstrap): the same data give the same numbers on every machine, in any order.
#pragma once

#include <cstdint>
#include <vector>

namespace ed3r::statistics {

class Resampler {
 public:
  // group_of_unit: for each unit its network, 0 .. groups-1; a group may be empty.
  Resampler(std::vector<int> group_of_unit, int groups);

  int groups() const { return static_cast<int>(members_.size()); }
  std::size_t units() const { return units_; }

  // How often resample number `resample` holds each unit (each network).
  void DrawMissions(int resample, std::vector<int>& count_of_unit) const;
  void DrawNetworks(int resample, std::vector<int>& count_of_group) const;

 private:
  std::size_t units_;
  std::vector<std::vector<int>> members_;
};

// A number and what it was in each resample; NaN where a resample could not give it. `networks` is empty where
// there is only one: then everything below is over missions alone.
struct Resampled {
  double value = 0;
  std::vector<double> missions, networks;
  int network_count = 1;
  // Of the arm with the fewest: its missions, and the networks within which they were drawn. 0 missions: not told, many.
  std::int64_t units = 0, strata = 1;
  std::int64_t trained = 0;  // networks that the arm flew; 0 where it asks none
};

// What chance leaves open. NaN where resamples are missing (under half of them gave a number), or missions.
struct Uncertainty {
  double lo,
      hi;  // 95 %: percentiles over missions, widened as above, Student's t over networks, whichever reaches further
  double sd_missions;  // standard deviations of the estimate
  double sd_networks;  // scaled as above; NaN with one network
};
Uncertainty UncertaintyOf(const Resampled& number);

// p-values of "the number is above `threshold`" and "below": twice the one-sided ones (so that p < 0.05 goes
// with a 95 % interval), Student's t over missions (normal where their number is not told) and over networks, the larger of both.
// Where all resamples are one number that tells nothing of the spread: then the sign test's, 2^(1 - n). 1 where nothing is known.
struct Sides {
  double above, below;
};
Sides TestAgainst(const Resampled& number, const Uncertainty& uncertainty, double threshold);

}  // namespace ed3r::statistics
