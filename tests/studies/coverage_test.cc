// Do 95 % intervals hold the truth in 95 % of samples? Synthetic arms whose truth is known in closed form:
// skewed energies with a lump at the battery's capacity, timesteps that resemble each other within a mission.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/random.h"
#include "studies/statistics/intervals.h"

namespace ed3r {
namespace {

constexpr double kBattery_kj = 139.86;

double Exponential(Stream& stream, double mean) { return -mean * std::log(1 - stream.Uniform()); }

// How many of `repetitions` samples have an interval that holds `truth`.
template <class Draw>
double Coverage(int repetitions, double truth, Draw draw) {
  int held = 0;
  for (int r = 0; r < repetitions; ++r) {
    Stream stream(11, static_cast<std::uint32_t>(r), Purpose::kBootstrap);
    const statistics::Interval interval = draw(stream);
    held += interval.lo <= truth && truth <= interval.hi;
  }
  return static_cast<double>(held) / repetitions;
}

// An arm by its shares of depleted missions and false positives and the mean energy of the others.
struct EnergyArm {
  double depleted, false_positive, mean_kj;

  // A false positive ends early, at three quarters of the energy; a depleted mission leaves up to 2 kJ.
  double MeanOfSuccess() const { return 2.5 + mean_kj * (1 - std::exp(-(kBattery_kj - 3.5) / mean_kj)); }
  double Wasted() const { return depleted * (kBattery_kj - 1) + false_positive * 0.75 * MeanOfSuccess(); }
  double Mean() const { return Wasted() + (1 - depleted - false_positive) * MeanOfSuccess(); }

  void Draw(Stream& stream, int n, std::vector<double>& energy, std::vector<double>& wasted) const {
    energy.clear(), wasted.clear();
    for (int i = 0; i < n; ++i) {
      const double fate = stream.Uniform();
      double e = std::min(2.5 + Exponential(stream, mean_kj), kBattery_kj - 1);
      if (fate < depleted) {
        e = kBattery_kj - stream.Uniform(0, 2);
      } else if (fate < depleted + false_positive) {
        e *= 0.75;
      }
      energy.push_back(e);
      wasted.push_back(fate < depleted + false_positive ? e : 0);
    }
  }

  double MeanCoverage(int n, int repetitions) const {
    std::vector<double> energy, wasted;
    return Coverage(repetitions, Mean(), [&](Stream& stream) {
      Draw(stream, n, energy, wasted);
      return statistics::MeanInterval(energy);
    });
  }

  double WastedShareCoverage(int n, int repetitions) const {
    std::vector<double> energy, wasted;
    return Coverage(repetitions, Wasted() / Mean(), [&](Stream& stream) {
      Draw(stream, n, energy, wasted);
      return statistics::ShareInterval(wasted, energy, statistics::ShareUnit::kMission);
    });
  }
};

// Shaped by what the paper reports for ED3R-75, RBS and ablation 2.
constexpr EnergyArm kEd3r{0.0141, 0.0141, 17}, kRbs{0.018, 0.214, 31}, kAblation2{0.173, 0.05, 22};

void ExpectNominal(double coverage) {
  EXPECT_GE(coverage, 0.93);
  EXPECT_LE(coverage, 0.97);
}

TEST(CoverageTest, MeanEnergyOf850Missions) {
  for (const EnergyArm& arm : {kEd3r, kRbs, kAblation2}) ExpectNominal(arm.MeanCoverage(850, 2000));
}

// A sample of 20 misses rare depletions more often than not; the interval must still not be wild.
TEST(CoverageTest, MeanEnergyOf20Missions) {
  EXPECT_GE(kEd3r.MeanCoverage(20, 4000), 0.85);
  EXPECT_GE(kRbs.MeanCoverage(20, 4000), 0.88);
  EXPECT_GE(kAblation2.MeanCoverage(20, 4000), 0.90);
}

TEST(CoverageTest, WastedEnergyOf850Missions) {
  for (const EnergyArm& arm : {kEd3r, kRbs, kAblation2}) ExpectNominal(arm.WastedShareCoverage(850, 2000));
}

TEST(CoverageTest, WastedEnergyOfFewMissions) {
  for (const EnergyArm& arm : {kEd3r, kRbs, kAblation2}) {
    EXPECT_GE(arm.WastedShareCoverage(5, 4000), 0.93);
    EXPECT_GE(arm.WastedShareCoverage(20, 4000), 0.93);
  }
}

TEST(CoverageTest, RateOf850Missions) {
  for (const double rate : {0.0141, 0.2318, 0.9718}) {
    ExpectNominal(Coverage(4000, rate, [rate](Stream& stream) {
      int events = 0;
      for (int i = 0; i < 850; ++i) events += stream.Uniform() < rate;
      return statistics::RateInterval(events, 850);
    }));
  }
}

// Missions of two kinds: long ones that offload much, short ones that offload little.
struct TimestepArm {
  double much = 0.4, little = 0.04, more_steps_long = 14, more_steps_short = 7;

  // Two timesteps and a geometric number of further ones.
  static int Steps(Stream& stream, double more) {
    return 2 + static_cast<int>(std::log(1 - stream.Uniform()) / std::log(more / (1 + more)));
  }
  double Share() const {
    const double long_steps = 2 + more_steps_long, short_steps = 2 + more_steps_short;
    return (much * long_steps + little * short_steps) / (long_steps + short_steps);
  }
  void Draw(Stream& stream, int n, std::vector<double>& part, std::vector<double>& whole) const {
    part.clear(), whole.clear();
    for (int i = 0; i < n; ++i) {
      const bool is_long = stream.Uniform() < 0.5;
      const int steps = Steps(stream, is_long ? more_steps_long : more_steps_short);
      int offloads = 0;
      for (int k = 0; k < steps; ++k) offloads += stream.Uniform() < (is_long ? much : little);
      part.push_back(offloads), whole.push_back(steps);
    }
  }
};

TEST(CoverageTest, ShareOfTimestepsClusteredInMissions) {
  const TimestepArm arm;
  std::vector<double> part, whole;
  const auto share = [&](int n) {
    return [&, n](Stream& stream) {
      arm.Draw(stream, n, part, whole);
      return statistics::ShareInterval(part, whole, statistics::ShareUnit::kTimestep);
    };
  };
  ExpectNominal(Coverage(1000, arm.Share(), share(850)));
  ExpectNominal(Coverage(2000, arm.Share(), share(100)));
  EXPECT_GE(Coverage(4000, arm.Share(), share(5)), 0.88);
}

// Why the shares are not Wilson on pooled timesteps.
TEST(CoverageTest, PooledTimestepsAreOverconfident) {
  const TimestepArm arm;
  std::vector<double> part, whole;
  const double coverage = Coverage(1000, arm.Share(), [&](Stream& stream) {
    arm.Draw(stream, 850, part, whole);
    double offloads = 0, steps = 0;
    for (std::size_t i = 0; i < part.size(); ++i) offloads += part[i], steps += whole[i];
    return statistics::RateInterval(std::llround(offloads), std::llround(steps));
  });
  EXPECT_LT(coverage, 0.85);
}

// Stable confidence scores: a mission's two to five reliable timesteps share most of their deviation.
TEST(CoverageTest, MeanConfidenceOfReliableTimesteps) {
  for (const int n : {30, 850}) {
    std::vector<double> sum, count;
    ExpectNominal(Coverage(2000, 0.9, [&](Stream& stream) {
      sum.clear(), count.clear();
      for (int i = 0; i < n; ++i) {
        const double mission = 0.9 + stream.Uniform(-0.08, 0.08);
        const int steps = stream.Uniform() < 0.1 ? 0 : 2 + static_cast<int>(stream.Below(4));
        double scs = 0;
        for (int k = 0; k < steps; ++k) scs += mission + stream.Uniform(-0.02, 0.02);
        sum.push_back(scs), count.push_back(steps);
      }
      return statistics::RatioInterval(sum, count);
    }));
  }
}

// Mean power, energy over time, where longer missions draw more: E[d (120 + d / 60)] / E[d] = 120 + 2 mean
// / 60.
TEST(CoverageTest, MeanPower) {
  const double mean_s = 180;
  std::vector<double> energy, time;
  ExpectNominal(Coverage(2000, 120 + 2 * mean_s / 60, [&](Stream& stream) {
    energy.clear(), time.clear();
    for (int i = 0; i < 850; ++i) {
      const double d = Exponential(stream, mean_s);
      time.push_back(d), energy.push_back(d * (120 + d / 60 + stream.Uniform(-8, 8)));
    }
    return statistics::RatioInterval(energy, time);
  }));
}

TEST(CoverageTest, EightyFifthPercentile) {
  const double mean_min = 2.5;
  for (const int n : {30, 850}) {
    std::vector<double> sorted;
    const double coverage = Coverage(1500, -mean_min * std::log(0.15), [&](Stream& stream) {
      sorted.clear();
      for (int i = 0; i < n; ++i) sorted.push_back(Exponential(stream, mean_min));
      std::sort(sorted.begin(), sorted.end());
      return statistics::QuantileInterval(sorted, 85);
    });
    EXPECT_GE(coverage, 0.945);  // at least 95 % by construction
    EXPECT_LE(coverage, 0.985);
  }
}

}  // namespace
}  // namespace ed3r
