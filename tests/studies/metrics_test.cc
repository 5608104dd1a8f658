#include "studies/metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "engine/core/check.h"
#include "tests/studies/five_missions.h"

namespace ed3r {
namespace {

struct Expected {
  const char* metric;
  double value, lo, hi;
  int n;
};

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Values by hand (five_missions.h); intervals from the formulas in a separate program (SciPy's t and normal
// quantiles). Lower ends of t intervals that would be negative are 0.
constexpr Expected kExpected[] = {
    {"total_energy_kj", 48, 0, 116.671765, 5},
    {"movement_energy_kj", 46.6, 0, 113.951545, 5},
    {"computation_energy_kj", 0.67, 0.0687217, 1.2712783, 5},
    {"transmission_energy_kj", 0.23, 0.0406717, 0.4193283, 5},
    {"sensing_energy_kj", 0.5, 0, 1.3713792, 5},
    {"mscs_pct", 84, 72.757358, 95.242642, 4},
    {"msr_pct", 60, 23.072428, 88.237923, 5},
    {"wer_pct", 63.083333, 9.879759, 96.381461, 5},
    {"fp_pct", 20, 3.622411, 62.446537, 5},
    {"bd_pct", 20, 3.622411, 62.446537, 5},
    {"or_pct", 16, 8.328383, 28.538338, 5},
    {"model_full_pct", 77, 59.848109, 88.262040, 5},
    {"model_quant_pct", 23, 11.737960, 40.151891, 5},
    {"lf_accuracy_pct", 53.125, 0, 100, 4},
    {"er_pct", 16, 8.328383, 28.538338, 5},
    {"duration_mean_min", 6.6, 0, 15.717991, 5},
    {"duration_p85_min", 18, kNone, kNone, 5},
    {"duration_max_min", 18, kNone, kNone, 5},
    {"within_10min_pct", 80, 37.553463, 96.377589, 5},
    {"timesteps_mean", 20, 0, 54.855169, 5},
    {"seconds_per_timestep", 19.8, 4.010164, 35.589836, 5},
    {"mean_power_w", 121.212121, 98.265621, 144.158621, 5},
};

void ExpectNear(double actual, double expected, const std::string& what) {
  if (std::isnan(expected)) {
    EXPECT_TRUE(std::isnan(actual)) << what << ' ' << actual;
  } else {
    EXPECT_NEAR(actual, expected, 2e-6) << what;
  }
}

TEST(MetricsTest, FiveMissionsByHand) {
  const metrics::ArmMetrics metrics = metrics::ComputeMetrics(FiveMissions());
  ASSERT_EQ(metrics.values.size(), std::size(kExpected));
  for (const Expected& expected : kExpected) {
    const metrics::MetricValue& ours = metrics[expected.metric];
    const std::string name = expected.metric;
    ExpectNear(ours.value, expected.value, name);
    ExpectNear(ours.lo, expected.lo, name + " lo");
    ExpectNear(ours.hi, expected.hi, name + " hi");
    EXPECT_EQ(ours.n, expected.n) << name;
  }
}

TEST(MetricsTest, CountsAndNamesAreKept) {
  const metrics::ArmMetrics metrics = metrics::ComputeMetrics(FiveMissions());
  EXPECT_EQ(metrics.stage, "online");
  EXPECT_EQ(metrics.name, "ed3r-75");
  EXPECT_EQ(metrics.missions, 5);
  EXPECT_EQ(metrics.failed, 1);
  EXPECT_EQ(metrics.missing, 2);
}

// The names that scripts rely on.
TEST(MetricsTest, NamesAreTheContract) {
  std::string names;
  for (const metrics::MetricDefinition& metric : metrics::MetricDefinitions())
    names += std::string(metric.name) + ' ';
  EXPECT_EQ(names,
            "total_energy_kj movement_energy_kj computation_energy_kj transmission_energy_kj "
            "sensing_energy_kj mscs_pct msr_pct wer_pct fp_pct bd_pct or_pct model_full_pct model_quant_pct "
            "lf_accuracy_pct er_pct duration_mean_min duration_p85_min duration_max_min within_10min_pct "
            "timesteps_mean seconds_per_timestep mean_power_w ");
  EXPECT_THROW(metrics::MetricIndex("msr"), InternalError);
}

TEST(MetricsTest, OrderOfMissionsDoesNotMatter) {
  metrics::ArmData arm = FiveMissions();
  const metrics::ArmMetrics forward = metrics::ComputeMetrics(arm);
  std::reverse(arm.missions.begin(), arm.missions.end());
  const metrics::ArmMetrics backward = metrics::ComputeMetrics(arm);
  for (std::size_t i = 0; i < forward.values.size(); ++i)
    ExpectNear(backward.values[i].value, forward.values[i].value,
               std::string(metrics::MetricDefinitions()[i].name));
}

TEST(MetricsTest, NoMissionGivesNoValues) {
  const metrics::ArmMetrics metrics =
      metrics::ComputeMetrics({.stage = "online", .name = "rbs", .missions = {}, .missing = 850});
  EXPECT_EQ(metrics.missing, 850);
  for (const metrics::MetricValue& ours : metrics.values) {
    EXPECT_TRUE(std::isnan(ours.value) && std::isnan(ours.lo) && std::isnan(ours.hi));
    EXPECT_EQ(ours.n, 0);
  }
}

TEST(MetricsTest, OneMissionGivesValuesWithoutIntervals) {
  metrics::ArmData arm = FiveMissions();
  arm.missions.resize(1);
  const metrics::ArmMetrics metrics = metrics::ComputeMetrics(arm);
  for (const metrics::MetricValue& ours : metrics.values) {
    EXPECT_FALSE(std::isnan(ours.value));
    EXPECT_TRUE(std::isnan(ours.lo) && std::isnan(ours.hi));
  }
  EXPECT_DOUBLE_EQ(metrics["mean_power_w"].value, 7600.0 / 60);
  EXPECT_EQ(metrics["lf_accuracy_pct"].value, 0);  // the only mission is the worst one
}

TEST(MetricsTest, StrategiesWithoutNetworksHaveNoLookForwardAccuracy) {
  metrics::ArmData arm = FiveMissions();
  for (mission::MissionRecord& mission : arm.missions) Predict(mission, 0, 0);
  EXPECT_TRUE(std::isnan(metrics::ComputeMetrics(arm)["lf_accuracy_pct"].value));
  for (mission::MissionRecord& mission : arm.missions) Predict(mission, mission.timesteps, 0);
  EXPECT_EQ(metrics::ComputeMetrics(arm)["lf_accuracy_pct"].value, 100);
}

TEST(MetricsTest, LookForwardAccuracyIsRelativeToTheNetworksOwnWorst) {
  metrics::ArmData arm = FiveMissions();
  arm.missions.resize(4);
  const double errors[] = {0.1, 0.2, 0.4, 0.8};
  for (std::size_t i = 0; i < 4; ++i) {
    mission::MissionRecord& mission = arm.missions[i];
    Predict(mission, mission.timesteps, errors[i] * static_cast<double>(mission.timesteps));
    mission.network = i < 2 ? 0 : 1;
  }
  EXPECT_DOUBLE_EQ(metrics::ComputeMetrics(arm)["lf_accuracy_pct"].value, 25);  // 50, 0, 50, 0
}

TEST(MetricsTest, IntervalsStayWithinWhatIsPossible) {
  const metrics::ArmData five = FiveMissions();
  for (std::size_t a = 0; a < 5; ++a)
    for (std::size_t b = 0; b < 5; ++b) {
      metrics::ArmData pair = five;
      pair.missions = {five.missions[a], five.missions[b]};
      const metrics::ArmMetrics metrics = metrics::ComputeMetrics(pair);
      for (std::size_t i = 0; i < metrics.values.size(); ++i) {
        const metrics::MetricValue& ours = metrics.values[i];
        if (std::isnan(ours.lo)) continue;
        EXPECT_GE(ours.lo, 0);
        EXPECT_LE(ours.lo, ours.value * (1 + 1e-12));
        EXPECT_GE(ours.hi, ours.value * (1 - 1e-12));
        if (metrics::MetricDefinitions()[i].unit == "%") {
          EXPECT_LE(ours.hi, 100);
        }
      }
    }
}

TEST(MetricsTest, RecordsThatCannotBeAreRefused) {
  const auto with = [](auto change) {
    metrics::ArmData arm = FiveMissions();
    change(arm.missions[2]);
    return arm;
  };
  EXPECT_NO_THROW(metrics::ComputeMetrics(with([](mission::MissionRecord&) {})));
  EXPECT_THROW(metrics::ComputeMetrics(with([](mission::MissionRecord& m) { m.outcome = 7; })),
               InternalError);
  EXPECT_THROW(metrics::ComputeMetrics(with([](mission::MissionRecord& m) { ++m.offloads; })), InternalError);
  EXPECT_THROW(metrics::ComputeMetrics(with([](mission::MissionRecord& m) { m.random_motions = 99; })),
               InternalError);
  EXPECT_THROW(metrics::ComputeMetrics(with([](mission::MissionRecord& m) { m.total_j = std::nan(""); })),
               InternalError);
  // Hovering left out of the movement energy.
  EXPECT_THROW(metrics::ComputeMetrics(with([](mission::MissionRecord& m) { m.movement_j -= 1000; })),
               InternalError);
}

TEST(SplitTest, EveryMissionIsInOneHalf) {
  const metrics::KnownUnseen sites = metrics::Split(FiveMissions(), metrics::SplitBy::kSite);
  EXPECT_EQ(sites.known.missions.size(), 2u);
  EXPECT_EQ(sites.unseen.missions.size(), 3u);
  EXPECT_EQ(sites.unseen.name, "ed3r-75");
  EXPECT_EQ(sites.unseen.stage, "online");
  const metrics::KnownUnseen stations = metrics::Split(FiveMissions(), metrics::SplitBy::kBaseStation);
  EXPECT_EQ(stations.known.missions.size(), 2u);
  EXPECT_DOUBLE_EQ(metrics::ComputeMetrics(stations.known)["total_energy_kj"].value, (7.6 + 20) / 2);
  EXPECT_DOUBLE_EQ(metrics::ComputeMetrics(sites.known)["total_energy_kj"].value, (7.6 + 12) / 2);
}

}  // namespace
}  // namespace ed3r
