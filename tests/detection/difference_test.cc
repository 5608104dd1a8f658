#include "studies/detection/difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/core/random.h"
#include "studies/detection/scores.h"

namespace ed3r::detection {
namespace {

// Two detectors whose scores are normal, positives around +kShift, negatives around -kShift, standard deviation 1, of
// which the view makes three quarters of the variance, plus noise of each detector's own.
constexpr double kShift = 1.25;
constexpr double kSlope = 3.0;  // confidence = logistic(kSlope * score)

struct Study {
  std::vector<FrameLabel> labels;
  std::vector<double> first, second;

  DetectorDifference Compare() const {
    return SecondMinusFirst(first, second, labels, All(labels).frames, kSomeResamples);
  }
};

double Confidence(double score) { return 1.0 / (1.0 + std::exp(-kSlope * score)); }

struct Noise {
  double first, second;  // standard deviations
};

Study Draw(std::uint64_t seed, int views, int frames, Noise noise) {
  Study study;
  for (int v = 0; v < views; ++v) {
    Stream stream(seed, static_cast<std::uint32_t>(v), Purpose::kBootstrap);
    const bool positive = v % 2 == 0;
    const double of_view = (positive ? kShift : -kShift) + std::sqrt(0.75) * stream.Normal();
    const double first_of_view = noise.first * std::sqrt(0.75) * stream.Normal();
    const double second_of_view = noise.second * std::sqrt(0.75) * stream.Normal();
    for (int f = 0; f < frames; ++f) {
      const double score = of_view + 0.5 * stream.Normal();
      study.labels.push_back({.world = "w", .view = v, .positive = positive});
      study.first.push_back(Confidence(score + first_of_view + 0.5 * noise.first * stream.Normal()));
      study.second.push_back(Confidence(score + second_of_view + 0.5 * noise.second * stream.Normal()));
    }
  }
  return study;
}

// What an endless data set would say of a detector whose scores have this standard deviation.
struct Truth {
  double auc, accuracy, cross_entropy;
};
Truth TruthOf(double sd) {
  const auto normal = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
  Truth truth{normal(kShift * std::sqrt(2.0) / sd), normal(kShift / sd), 0.0};
  constexpr double kStep = 0.001;
  double weights = 0.0;
  for (double z = -8.0; z <= 8.0; z += kStep) {
    const double weight = std::exp(-0.5 * z * z);
    truth.cross_entropy += weight * std::log1p(std::exp(-kSlope * (kShift + sd * z)));
    weights += weight;
  }
  truth.cross_entropy /= weights;
  return truth;
}
Truth TrueDifference(Noise noise) {
  const Truth first = TruthOf(std::hypot(1.0, noise.first)), second = TruthOf(std::hypot(1.0, noise.second));
  return {second.auc - first.auc, second.accuracy - first.accuracy,
          second.cross_entropy - first.cross_entropy};
}

bool Covers(const Difference& difference, double truth) {
  return difference.interval.lo <= truth && truth <= difference.interval.hi;
}

void ExpectZero(const Difference& difference) {
  EXPECT_EQ(difference.value, 0.0);
  EXPECT_EQ(difference.interval.lo, 0.0);
  EXPECT_EQ(difference.interval.hi, 0.0);
  EXPECT_FALSE(difference.Distinguishable());
}

TEST(DetectorDifference, EqualDetectorsDifferByExactlyNothing) {
  Study study = Draw(1, 100, 3, {0.0, 0.5});
  study.second = study.first;
  const DetectorDifference d = study.Compare();
  ExpectZero(d.auc);
  ExpectZero(d.accuracy);
  ExpectZero(d.cross_entropy);
  EXPECT_EQ(d.decided_differently, 0);
}

TEST(DetectorDifference, AWorseDetectorIsFoundAndTheTruthCovered) {
  constexpr Noise kNoise{0.0, 0.6};
  const Truth truth = TrueDifference(kNoise);
  const DetectorDifference d = Draw(2, 1000, 2, kNoise).Compare();
  for (const Difference& difference : {d.auc, d.accuracy}) {
    EXPECT_LT(difference.interval.lo, difference.value);
    EXPECT_LT(difference.value, difference.interval.hi);
    EXPECT_LT(difference.interval.hi, 0.0);
    EXPECT_TRUE(difference.Distinguishable());
  }
  EXPECT_GT(d.cross_entropy.interval.lo, 0.0);
  EXPECT_TRUE(Covers(d.auc, truth.auc)) << truth.auc;
  EXPECT_TRUE(Covers(d.accuracy, truth.accuracy)) << truth.accuracy;
  EXPECT_TRUE(Covers(d.cross_entropy, truth.cross_entropy)) << truth.cross_entropy;
}

TEST(DetectorDifference, IsThatOfTheScores) {
  const Study study = Draw(3, 50, 2, {0.0, 0.5});
  const std::vector<std::size_t> some = {0, 1, 2, 3, 10, 17, 18, 19, 42};
  const DetectorDifference d =
      SecondMinusFirst(study.first, study.second, study.labels, some, kSomeResamples);
  const DetectionScores first = ScoresOf(study.first, study.labels, some),
                        second = ScoresOf(study.second, study.labels, some);
  EXPECT_EQ(d.auc.value, second.auc - first.auc);
  EXPECT_NEAR(d.accuracy.value, second.accuracy - first.accuracy, 1e-12);
}

TEST(DetectorDifference, CopiesOfFramesInTheirViewsNarrowNothing) {
  const Study study = Draw(4, 100, 2, {0.0, 0.5});
  Study copied, independent;
  for (int copy = 0; copy < 4; ++copy)
    for (std::size_t i = 0; i < study.labels.size(); ++i)
      for (Study* s : {&copied, &independent}) {
        s->labels.push_back(study.labels[i]);
        s->first.push_back(study.first[i]);
        s->second.push_back(study.second[i]);
        if (s == &independent) s->labels.back().view += 100 * copy;
      }
  const DetectorDifference once = study.Compare(), again = copied.Compare(), wrong = independent.Compare();
  const auto expect_same = [](const Difference& a, const Difference& b) {
    EXPECT_NEAR(a.value, b.value, 1e-12);
    EXPECT_NEAR(a.interval.lo, b.interval.lo, 1e-12);
    EXPECT_NEAR(a.interval.hi, b.interval.hi, 1e-12);
  };
  expect_same(once.auc, again.auc);
  expect_same(once.accuracy, again.accuracy);
  expect_same(once.cross_entropy, again.cross_entropy);
  // Taken for views of their own they would halve it.
  const auto width = [](const Difference& d) { return d.interval.hi - d.interval.lo; };
  EXPECT_NEAR(width(wrong.auc), 0.5 * width(once.auc), 0.15 * width(once.auc));
  EXPECT_NEAR(width(wrong.cross_entropy), 0.5 * width(once.cross_entropy), 0.15 * width(once.cross_entropy));
}

TEST(DetectorDifference, SureAndWrongCostsAFiniteAmount) {
  const std::vector<FrameLabel> labels = {{.world = "w", .view = 0, .positive = true},
                                          {.world = "w", .view = 1, .positive = false}};
  const std::vector<double> first = {0.5, 0.5}, second = {0.0, 1.0};
  const DetectorDifference d = SecondMinusFirst(first, second, labels, {0, 1}, kSomeResamples);
  EXPECT_NEAR(d.cross_entropy.value, std::log(0.5) - std::log(kSmallestLikelihood), 1e-9);
  EXPECT_EQ(d.decided_differently, 1);  // 0.5 is "fire" already
}

TEST(DetectorDifference, FewViewsHaveNoInterval) {
  const auto compare = [](int views) { return Draw(5, views, 2, {0.0, 0.6}).Compare(); };
  const DetectorDifference few = compare(kFewestViews - 1), enough = compare(kFewestViews);
  for (const Difference& difference : {few.auc, few.accuracy, few.cross_entropy}) {
    EXPECT_FALSE(std::isnan(difference.value));
    EXPECT_FALSE(difference.interval.Exists());
    EXPECT_FALSE(difference.Distinguishable());
  }
  for (const Difference& difference : {enough.auc, enough.accuracy, enough.cross_entropy})
    EXPECT_TRUE(difference.interval.Exists());
  EXPECT_EQ(few.views, kFewestViews - 1);
  EXPECT_GT(few.decided_differently, 0);
}

TEST(DetectorDifference, AnAreaNeedsViewsOfBothKinds) {
  const Study study = Draw(6, 200, 2, {0.0, 0.6});
  std::vector<std::size_t> positives, few_negatives;
  for (std::size_t i = 0; i < study.labels.size(); ++i) {
    if (study.labels[i].positive) positives.push_back(i);
    if (study.labels[i].positive || study.labels[i].view < 2 * (kFewestViewsOfAKind - 1))
      few_negatives.push_back(i);
  }
  const auto compare = [&](const std::vector<std::size_t>& chosen) {
    return SecondMinusFirst(study.first, study.second, study.labels, chosen, kSomeResamples);
  };
  EXPECT_TRUE(std::isnan(compare(positives).auc.value));
  EXPECT_TRUE(compare(positives).cross_entropy.interval.Exists());
  EXPECT_FALSE(std::isnan(compare(few_negatives).auc.value));
  EXPECT_FALSE(compare(few_negatives).auc.interval.Exists());
  EXPECT_TRUE(compare(few_negatives).accuracy.interval.Exists());
  EXPECT_TRUE(std::isnan(compare({}).accuracy.value));
}

TEST(DetectorDifference, MoreResamplesSayTheSame) {
  const Study study = Draw(8, 200, 1, {0.0, 0.6});
  const std::vector<std::size_t> all = All(study.labels).frames;
  const DetectorDifference many =
      SecondMinusFirst(study.first, study.second, study.labels, all, kManyResamples);
  const DetectorDifference some = study.Compare();
  const double width = some.auc.interval.hi - some.auc.interval.lo;
  EXPECT_EQ(many.auc.value, some.auc.value);
  EXPECT_NEAR(many.auc.interval.lo, some.auc.interval.lo, 0.1 * width);
  EXPECT_NEAR(many.auc.interval.hi, some.auc.interval.hi, 0.1 * width);
}

struct Coverage {
  double auc = 0, accuracy = 0, cross_entropy = 0;
  double decided_differently = 0;  // views, on average
};

Coverage CoverageOf(int studies, int views, Noise noise) {
  Coverage coverage;
  const Truth truth = TrueDifference(noise);
  const double share = 1.0 / studies;
  for (int s = 0; s < studies; ++s) {
    const DetectorDifference d = Draw(static_cast<std::uint64_t>(100 + s), views, 2, noise).Compare();
    coverage.auc += Covers(d.auc, truth.auc) ? share : 0;
    coverage.accuracy += Covers(d.accuracy, truth.accuracy) ? share : 0;
    coverage.cross_entropy += Covers(d.cross_entropy, truth.cross_entropy) ? share : 0;
    coverage.decided_differently += share * d.decided_differently;
  }
  return coverage;
}

// 200 studies: one standard deviation of a share near 95 % is 1.5 points.
TEST(DetectorDifference, IntervalsCoverTheTruth) {
  for (const Noise noise : {Noise{0.0, 0.5}, Noise{0.3, 0.3}}) {
    const Coverage coverage = CoverageOf(200, 200, noise);
    EXPECT_GE(coverage.auc, 0.90);
    EXPECT_GE(coverage.accuracy, 0.90);
    EXPECT_GE(coverage.cross_entropy, 0.90);
  }
}

// Prints the table of studies/detection/difference.cc; minutes:
//   test_detection --gtest_also_run_disabled_tests --gtest_filter='*PrintsTheTable'
TEST(DetectorDifference, DISABLED_PrintsTheTable) {
  for (const int views : {50, 200, 900})
    for (const double noise : {0.05, 0.2, 0.6}) {
      const Coverage worse = CoverageOf(1000, views, {0.0, noise}),
                     equal = CoverageOf(1000, views, {noise, noise});
      std::printf("//  %5d  %5.2f  %9.1f  %8.1f %8.1f %12.1f  %10.1f %8.1f %12.1f\n", views, noise,
                  worse.decided_differently, 100 * worse.auc, 100 * worse.accuracy, 100 * worse.cross_entropy,
                  100 - 100 * equal.auc, 100 - 100 * equal.accuracy, 100 - 100 * equal.cross_entropy);
    }
}

}  // namespace
}  // namespace ed3r::detection
