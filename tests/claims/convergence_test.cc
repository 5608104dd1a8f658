#include "studies/claims/convergence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "studies/metrics/metrics.h"
#include "tests/claims/synthetic_run.h"
#include "tests/studies/csv_rows.h"

namespace ed3r::claims {
namespace {

const ConvergencePoint& At(const std::vector<ConvergencePoint>& points, std::string_view metric,
                           std::int64_t missions) {
  for (const ConvergencePoint& point : points)
    if (point.metric == metric && point.missions == missions) return point;
  throw std::out_of_range(std::string(metric));
}

TEST(ConvergenceTest, DoublesUpToAllMissions) {
  const std::vector<metrics::ArmData> arms = {MakeArm({"rbs", 20}, {.missions = 850})};
  const std::vector<ConvergencePoint> points = Convergence(arms);
  std::vector<std::int64_t> counts;
  for (const ConvergencePoint& point : points)
    if (point.metric == "msr_pct") counts.push_back(point.missions);
  EXPECT_EQ(counts, (std::vector<std::int64_t>{50, 100, 200, 400, 800, 850}));
}

TEST(ConvergenceTest, TheLastPointIsTheTables) {
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20, 0.1, 0.3})};
  const metrics::MetricValue table = metrics::ComputeMetrics(arms[0])["total_energy_kj"];
  const ConvergencePoint last = At(Convergence(arms), "total_energy_kj", 280);
  EXPECT_EQ(last.value, table.value);
  EXPECT_EQ(last.half_width, (table.hi - table.lo) / 2);
  EXPECT_EQ(last.networks, 5);
  EXPECT_LT(last.half_width_missions, 0.5 * last.half_width);
}

// Sixteen times the missions: a quarter of the width, but only where training had no luck.
TEST(ConvergenceTest, MissionsDoNotBuyOffTheLuckOfTraining) {
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20, 0, 0.3}, {.missions = 2240})};
  const std::vector<ConvergencePoint> points = Convergence(arms);
  const ConvergencePoint few = At(points, "total_energy_kj", 200), many = At(points, "total_energy_kj", 2240);
  EXPECT_NEAR(many.half_width_missions / few.half_width_missions, std::sqrt(200.0 / 2240), 0.04);
  EXPECT_GT(many.half_width / few.half_width, 0.6);
}

TEST(ConvergenceTest, SmallArmsHaveNone) {
  EXPECT_TRUE(Convergence(std::vector<metrics::ArmData>{MakeArm({"rbs", 20}, {.missions = 49})}).empty());
  EXPECT_EQ(CsvRows(ConvergenceCsv({})).size(), 1u);
}

TEST(ConvergenceTest, CsvHasEveryPoint) {
  const std::vector<ConvergencePoint> points =
      Convergence(std::vector<metrics::ArmData>{MakeArm({"rbs", 20}, {.missions = 60})});
  const std::vector<CsvRow> rows = CsvRows(ConvergenceCsv(points));
  ASSERT_EQ(rows.size(), points.size() + 1);
  EXPECT_EQ(rows[1][1], "rbs");
  EXPECT_EQ(rows[1][3], "50");
}

}  // namespace
}  // namespace ed3r::claims
