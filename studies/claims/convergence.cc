#include "studies/claims/convergence.h"

#include <fmt/format.h>

#include "engine/core/files/csv_table.h"
#include "studies/metrics/metrics.h"
#include "studies/metrics/number_text.h"

namespace ed3r::claims {
namespace {

constexpr std::int64_t kFewest = 50;
constexpr std::string_view kMetrics[] = {"total_energy_kj", "msr_pct",  "wer_pct",          "fp_pct",
                                         "bd_pct",          "mscs_pct", "duration_mean_min"};

double HalfWidth(const metrics::MetricValue& value) { return (value.hi - value.lo) / 2; }

metrics::ArmData FirstMissions(const metrics::ArmData& arm, std::int64_t count) {
  return {
      .stage = arm.stage, .name = arm.name, .missions = {arm.missions.begin(), arm.missions.begin() + count}};
}

void AddPoints(const metrics::ArmData& some, std::vector<ConvergencePoint>& points) {
  const metrics::ArmMetrics with_networks = metrics::ComputeMetrics(some);
  metrics::ArmData pooled = some;
  for (mission::MissionRecord& mission : pooled.missions) mission.network = -1;
  const metrics::ArmMetrics over_missions = metrics::ComputeMetrics(pooled);
  for (const std::string_view metric : kMetrics)
    points.push_back({some.stage, some.name, metric, with_networks.missions, with_networks.networks,
                      with_networks[metric].value, HalfWidth(with_networks[metric]),
                      HalfWidth(over_missions[metric])});
}

}  // namespace

std::vector<ConvergencePoint> Convergence(std::span<const metrics::ArmData> arms) {
  std::vector<ConvergencePoint> points;
  for (const metrics::ArmData& arm : arms) {
    const auto all = static_cast<std::int64_t>(arm.missions.size());
    if (all < kFewest) continue;
    for (std::int64_t count = kFewest; count < all; count *= 2) AddPoints(FirstMissions(arm, count), points);
    AddPoints(arm, points);
  }
  return points;
}

std::string ConvergenceCsv(const std::vector<ConvergencePoint>& points) {
  std::string csv = "stage,arm,metric,missions,networks,value,half_width,half_width_missions\n";
  for (const ConvergencePoint& point : points)
    csv += fmt::format("{},{},{},{},{},{},{},{}\n", CsvField(point.stage), CsvField(point.arm), point.metric,
                       point.missions, point.networks, metrics::CsvNumber(point.value),
                       metrics::CsvNumber(point.half_width), metrics::CsvNumber(point.half_width_missions));
  return csv;
}

}  // namespace ed3r::claims
