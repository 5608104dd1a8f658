// Coverage of the nominal 95 % intervals, and how often equally noisy detectors are called different
// (tests/detection/difference_test.cc, PrintsTheTable; 1,000 synthetic data sets each, 2 frames a view, kSomeResamples;
// noise: standard deviation that the second detector, or each of two equal ones, adds to scores of standard deviation
// 1; standard error of a share 0.7 points):
//
//                 decided    covered, %                        called different, %
//  views  noise  differently     AUC accuracy cross-entropy        AUC accuracy cross-entropy
//     50   0.05        0.7      91.8     31.7         93.7         1.2      0.2          7.5
//     50   0.20        2.7      93.3     78.4         92.8         4.8      3.7          7.9
//     50   0.60        7.7      92.5     92.8         92.1         6.7      6.0          7.8
//    200   0.05        2.9      96.7     78.1         94.7         3.7      3.3          5.7
//    200   0.20       11.0      94.9     94.1         94.7         4.9      4.0          5.4
//    200   0.60       30.9      94.5     95.1         94.5         4.1      4.7          4.8
//    900   0.05       13.1      94.6     93.3         94.5         4.1      4.2          4.8
//    900   0.20       50.2      95.0     95.0         94.4         4.7      4.1          5.0
//    900   0.60      139.9      95.6     95.4         94.4         5.0      4.8          5.8
//
// Where few views are decided differently, what the accuracy misses is a difference that no view at hand shows.
#include "studies/detection/difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/check.h"
#include "studies/detection/roc_area.h"
#include "studies/detection/scores.h"
#include "studies/detection/views.h"
#include "studies/statistics/resampling.h"

namespace ed3r::detection {
namespace {

// What the frames of one view add to the totals.
struct ViewTotals {
  double frames = 0.0, right = 0.0, cross_entropy = 0.0;
  bool positive = false, negative = false, decided_differently = false;  // of any of its frames
};

bool Fire(double confidence) { return confidence >= kDecision; }

double CrossEntropy(double confidence, bool positive) {
  const double likelihood = positive ? confidence : 1.0 - confidence;
  return -std::log(std::clamp(likelihood, kSmallestLikelihood, 1.0 - kSmallestLikelihood));
}

std::vector<ViewTotals> TotalsOf(std::span<const double> first, std::span<const double> second,
                                 std::span<const FrameLabel> labels, const std::vector<std::size_t>& chosen,
                                 const Views& views) {
  std::vector<ViewTotals> totals(static_cast<std::size_t>(views.count));
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    const std::size_t i = chosen[c];
    const bool positive = labels[i].positive;
    ViewTotals& view = totals[static_cast<std::size_t>(views.of_frame[c])];
    (positive ? view.positive : view.negative) = true;
    view.frames += 1.0;
    view.cross_entropy += CrossEntropy(second[i], positive) - CrossEntropy(first[i], positive);
    if (Fire(first[i]) == Fire(second[i])) continue;
    view.decided_differently = true;
    view.right += Fire(second[i]) == positive ? 1.0 : -1.0;
  }
  return totals;
}

double MeanOf(const std::vector<ViewTotals>& totals, double ViewTotals::*part, std::span<const int> counts) {
  double sum = 0.0, frames = 0.0;
  for (std::size_t v = 0; v < totals.size(); ++v) {
    sum += counts[v] * totals[v].*part;
    frames += counts[v] * totals[v].frames;
  }
  return frames > 0.0 ? sum / frames : std::numeric_limits<double>::quiet_NaN();
}

int CountOf(const std::vector<ViewTotals>& totals, bool ViewTotals::*what) {
  return static_cast<int>(
      std::count_if(totals.begin(), totals.end(), [&](const ViewTotals& view) { return view.*what; }));
}

Difference DifferenceOf(const statistics::Resampled& number, bool enough_views) {
  if (!enough_views) return {number.value, {}};
  const statistics::Uncertainty uncertainty = statistics::UncertaintyOf(number);
  return {number.value, {uncertainty.lo, uncertainty.hi}};
}

}  // namespace

DetectorDifference SecondMinusFirst(std::span<const double> first, std::span<const double> second,
                                    std::span<const FrameLabel> labels,
                                    const std::vector<std::size_t>& chosen, int resamples) {
  ED3R_CHECK(first.size() == labels.size() && second.size() == labels.size(), "one confidence per frame");
  const Views views = ViewsOf(labels, chosen);
  const RocArea first_area(first, labels, chosen, views.of_frame);
  const RocArea second_area(second, labels, chosen, views.of_frame);
  const std::vector<ViewTotals> totals = TotalsOf(first, second, labels, chosen, views);
  const bool enough = views.count >= kFewestViews;
  const bool enough_of_each = enough && CountOf(totals, &ViewTotals::positive) >= kFewestViewsOfAKind &&
                              CountOf(totals, &ViewTotals::negative) >= kFewestViewsOfAKind;

  std::vector<int> counts(totals.size(), 1);
  const auto area = [&] { return second_area.Of(counts) - first_area.Of(counts); };
  const auto right = [&] { return MeanOf(totals, &ViewTotals::right, counts); };
  const auto entropy = [&] { return MeanOf(totals, &ViewTotals::cross_entropy, counts); };
  statistics::Resampled areas, rights, entropies;
  areas.value = area(), rights.value = right(), entropies.value = entropy();
  // All views are of one group: there is one network of each kind, and a view is what the resampler calls a mission.
  const statistics::Resampler resampler(std::vector<int>(totals.size(), 0), 1);
  for (int b = 0; b < resamples && enough; ++b) {
    resampler.DrawMissions(b, counts);
    if (enough_of_each) areas.missions.push_back(area());
    rights.missions.push_back(right());
    entropies.missions.push_back(entropy());
  }
  return {.auc = DifferenceOf(areas, enough_of_each),
          .accuracy = DifferenceOf(rights, enough),
          .cross_entropy = DifferenceOf(entropies, enough),
          .views = views.count,
          .decided_differently = CountOf(totals, &ViewTotals::decided_differently)};
}

}  // namespace ed3r::detection
