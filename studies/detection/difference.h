// Whether one detector is measurably worse than another: paired differences, both having looked at the same frames.
//
// The unit is a view (views.h): a resample draws as many views as there are, with replacement, the same ones for both
// detectors, so what makes a view hard for both cancels. The difference is for the worlds and the networks at hand.
//
// Draws come from Stream(kBootstrap): the same data give the same numbers on every machine.
#pragma once

#include <span>
#include <vector>

#include "studies/detection/frame_set.h"
#include "studies/statistics/intervals.h"

namespace ed3r::detection {

// Likelihoods nearer to 0 count as this much: one frame on which a detector is sure and wrong shall not decide a mean.
// Float confidences near 1 come in steps of 6e-8; what lies beyond is rounding.
constexpr double kSmallestLikelihood = 1e-6;

// A resample can only repeat the views at hand; from few it knows too little of how views differ (with 20 the interval
// of an area covered the truth in 38 to 83 % of trials). So there is no interval below this many, nor one of an area
// below this many with and without fire. Coverage from there on: difference.cc.
constexpr int kFewestViews = 50;
constexpr int kFewestViewsOfAKind = 25;

// With fewer views decided differently than this, the interval of the accuracy may be too narrow (0 wide with none).
// What it calls different is so all the same.
constexpr int kFewDecidedDifferently = 10;

// Resampling itself leaves the ends of an interval uncertain, by about 3 and 10 % of the difference's standard
// deviation. The first is for what is printed and concluded from; 20,000 frames take seconds.
constexpr int kManyResamples = 10000;
constexpr int kSomeResamples = 1000;

struct Difference {
  double value;                   // NaN where the frames cannot give one
  statistics::Interval interval;  // 95 %; NaN where there are too few views

  // Chance alone does not explain it.
  bool Distinguishable() const { return interval.lo > 0.0 || interval.hi < 0.0; }
};

// Second minus first.
struct DetectorDifference {
  Difference auc;
  Difference accuracy;
  Difference cross_entropy;  // mean of -ln(likelihood of the label); more is worse
  int views = 0;
  int decided_differently = 0;  // views with a frame that one calls "fire" (kDecision) and the other does not
};

// One confidence of each detector per label, of the frames chosen. ED3R_CHECK: as many confidences as labels.
DetectorDifference SecondMinusFirst(std::span<const double> first, std::span<const double> second,
                                    std::span<const FrameLabel> labels,
                                    const std::vector<std::size_t>& chosen, int resamples);

}  // namespace ed3r::detection
