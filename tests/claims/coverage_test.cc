// How often the two-level interval of a paired difference holds the truth, and how often a test at 5 % is
// wrong.
//
// Synthetic studies: missions' energies are log-normal (a hard scenario is hard for both arms), every network
// moves its arm's energies by a factor of its own, networks are shared by index but lucky or unlucky in each
// arm separately.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "engine/core/random.h"
#include "studies/statistics/resampling.h"

namespace ed3r::claims {
namespace {

struct Design {
  int networks, missions_each;
  double luck;  // standard deviation of a network's factor
  int studies, resamples;
};

struct Coverage {
  double covered = 0, covered_by_missions = 0, wrong = 0;  // shares of the studies
  double half_width = 0;                                   // mean
};

struct Study {
  std::vector<int> network;
  std::vector<double> first, second;
};

Study Draw(const Design& design, int number) {
  Stream stream(99, static_cast<std::uint32_t>(number), Purpose::kScenario);
  Study study;
  for (int g = 0; g < design.networks; ++g) {
    const double first = 1 + design.luck * stream.Normal(), second = 1 + design.luck * stream.Normal();
    for (int i = 0; i < design.missions_each; ++i) {
      const double hardness = std::exp(0.8 * stream.Normal());
      study.network.push_back(g);
      study.first.push_back(20 * first * hardness * std::exp(0.5 * stream.Normal()));
      study.second.push_back(20 * second * hardness * std::exp(0.5 * stream.Normal()));
    }
  }
  return study;
}

statistics::Resampled Difference(const Study& study, const Design& design) {
  const statistics::Resampler resampler(study.network, design.networks);
  std::vector<int> counts;
  const auto difference = [&](auto count) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < study.first.size(); ++i)
      sum += count(i) * (study.first[i] - study.second[i]), all += count(i);
    return sum / all;
  };
  statistics::Resampled result;
  result.network_count = design.networks;
  result.units = static_cast<std::int64_t>(study.first.size()), result.strata = design.networks;
  result.value = difference([](std::size_t) { return 1; });
  for (int b = 0; b < design.resamples; ++b) {
    resampler.DrawMissions(b, counts);
    result.missions.push_back(difference([&](std::size_t i) { return counts[i]; }));
    resampler.DrawNetworks(b, counts);
    result.networks.push_back(
        difference([&](std::size_t i) { return counts[static_cast<std::size_t>(study.network[i])]; }));
  }
  return result;
}

Coverage Fly(const Design& design) {
  Coverage outcome;
  const double share = 1.0 / design.studies;
  for (int s = 0; s < design.studies; ++s) {
    statistics::Resampled number = Difference(Draw(design, s), design);
    const statistics::Uncertainty u = statistics::UncertaintyOf(number);
    outcome.covered += u.lo <= 0 && 0 <= u.hi ? share : 0;  // the arms are alike in truth
    outcome.half_width += share * (u.hi - u.lo) / 2;
    const statistics::Sides sides = statistics::TestAgainst(number, u, 0);
    outcome.wrong += sides.above < 0.05 || sides.below < 0.05 ? share : 0;
    number.networks.clear(), number.network_count = 1;
    const statistics::Uncertainty missions = statistics::UncertaintyOf(number);
    outcome.covered_by_missions += missions.lo <= 0 && 0 <= missions.hi ? share : 0;
  }
  return outcome;
}

// 400 studies: one standard deviation of a share near 95 % is 1.1 points.
TEST(CoverageTest, HoldsWithFewLuckyNetworks) {
  const Coverage outcome =
      Fly({.networks = 5, .missions_each = 40, .luck = 0.2, .studies = 400, .resamples = 300});
  EXPECT_GE(outcome.covered, 0.92);
  EXPECT_LE(outcome.wrong, 0.08);
  EXPECT_LE(outcome.covered_by_missions, 0.75);  // what leaving out the luck of training would do
}

TEST(CoverageTest, ErrsOnTheWideSideWithoutLuck) {
  const Coverage outcome =
      Fly({.networks = 5, .missions_each = 40, .luck = 0, .studies = 400, .resamples = 300});
  EXPECT_GE(outcome.covered, 0.93);
  EXPECT_LE(outcome.wrong, 0.07);
}

// Prints the table of studies/statistics/resampling.cc; about two minutes:
//   test_claims --gtest_also_run_disabled_tests --gtest_filter='*PrintsTheTable'
TEST(CoverageTest, DISABLED_PrintsTheTable) {
  for (const int networks : {2, 3, 5, 10})
    for (const double luck : {0.0, 0.05, 0.2}) {
      const Coverage o = Fly({.networks = networks,
                              .missions_each = 850 / networks,
                              .luck = luck,
                              .studies = 1000,
                              .resamples = 300});
      std::printf("%8d %6.2f %9.1f %9.1f %9.1f %8.2f\n", networks, luck, 100 * o.covered,
                  100 * o.covered_by_missions, 100 * o.wrong, o.half_width);
    }
}

}  // namespace
}  // namespace ed3r::claims
