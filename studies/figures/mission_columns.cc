#include "studies/figures/mission_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "studies/metrics/metrics.h"

namespace ed3r::figures {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Column {
  const char *name, *meaning;
  double (*value)(const mission::MissionRecord&);
};

constexpr Column kColumns[] = {
    {"scenario", "number of the draws it met; equal numbers of two arms are the same fire, start and weather",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.scenario); }},
    {"site", "fire site, from 0",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.site); }},
    {"site_known", "1: the warm-up had seen the site",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.site_known); }},
    {"base_station", "from 0",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.base_station); }},
    {"network", "which training seed flew it, -1: none",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.network); }},
    {"outcome", "0 success, 1 false positive, 2 battery depleted",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.outcome); }},
    {"timesteps", "", [](const mission::MissionRecord& m) { return static_cast<double>(m.timesteps); }},
    {"duration_min", "min", [](const mission::MissionRecord& m) { return m.duration_s / 60; }},
    {"energy_kj", "total energy, kJ", [](const mission::MissionRecord& m) { return m.total_j / 1000; }},
    {"movement_kj", "kJ, hovering included",
     [](const mission::MissionRecord& m) { return m.movement_j / 1000; }},
    {"computation_kj", "kJ", [](const mission::MissionRecord& m) { return m.computation_j / 1000; }},
    {"transmission_kj", "kJ", [](const mission::MissionRecord& m) { return m.transmission_j / 1000; }},
    {"sensing_kj", "kJ", [](const mission::MissionRecord& m) { return m.sensing_j / 1000; }},
    {"scs_pct", "mean stable confidence score of its reliable timesteps, %; null without any",
     [](const mission::MissionRecord& m) {
       return m.reliable_timesteps > 0 ? 100 * m.reliable_scs_sum / static_cast<double>(m.reliable_timesteps)
                                       : kNone;
     }},
    {"offloads", "timesteps that were processed at the remote controller",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.offloads); }},
    {"full_local", "timesteps with the Full model on board",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.full_local); }},
    {"quantized_local", "timesteps with the Quantized model on board",
     [](const mission::MissionRecord& m) { return static_cast<double>(m.quantized_local); }},
};

Json LookForward(const metrics::ArmData& arm) {
  Json column = Json::array();
  for (const double accuracy :
       metrics::LookForwardAccuracies(arm.missions, metrics::WorstErrorsOf(arm.missions)))
    column.push_back(Rounded(100 * accuracy));
  return column;
}

// How these missions ended, with the tables' interval of success: it includes the luck of training.
Json Outcomes(const metrics::ArmData& arm) {
  const metrics::ArmMetrics metrics = metrics::ComputeMetrics(arm);
  const metrics::MetricValue& success = metrics["msr_pct"];
  return {{"missions", metrics.missions},
          {"success_pct", Rounded(success.value)},
          {"lo", Rounded(success.lo)},
          {"hi", Rounded(success.hi)},
          {"false_positive_pct", Rounded(metrics["fp_pct"].value)},
          {"depleted_pct", Rounded(metrics["bd_pct"].value)}};
}

}  // namespace

Json Rounded(double value, int decimals) {
  if (std::isnan(value)) return nullptr;
  const double scale = std::pow(10.0, decimals);
  const double rounded = std::round(value * scale) / scale;
  if (rounded == std::floor(rounded) && std::abs(rounded) < 1e15) return static_cast<std::int64_t>(rounded);
  return rounded;
}

Json ColumnUnits() {
  Json units = Json::object();
  for (const Column& column : kColumns) units[column.name] = column.meaning;
  units["lf_accuracy_pct"] =
      "look-forward accuracy, relative to the worst mission of the same network, %; null without predictions";
  return units;
}

Json MissionColumns(const metrics::ArmData& arm) {
  Json columns = Json::object();
  for (const Column& column : kColumns) {
    Json& values = columns[column.name] = Json::array();
    for (const mission::MissionRecord& mission : arm.missions)
      values.push_back(Rounded(column.value(mission)));
  }
  columns["lf_accuracy_pct"] = LookForward(arm);
  return columns;
}

Json SiteSuccess(const metrics::ArmData& arm) {
  std::map<std::int64_t, metrics::ArmData> sites;
  for (const mission::MissionRecord& mission : arm.missions) sites[mission.site].missions.push_back(mission);
  Json list = Json::array();
  for (const auto& [site, flown] : sites) {
    Json json = {{"site", site}, {"known", flown.missions.back().site_known != 0}};
    json.update(Outcomes(flown));
    list.push_back(json);
  }
  return list;
}

Json PooledSuccess(const metrics::ArmData& arm, bool known) {
  const metrics::KnownUnseen sites = metrics::Split(arm, metrics::SplitBy::kSite);
  const metrics::ArmData& flown = known ? sites.known : sites.unseen;
  return flown.missions.empty() ? Json(nullptr) : Outcomes(flown);
}

Json ConvergenceJson(const metrics::ArmData& arm, std::span<const claims::ConvergencePoint> points) {
  Json curves = Json::object();
  for (const claims::ConvergencePoint& point : points) {
    if (point.stage != arm.stage || point.arm != arm.name) continue;
    Json& curve = curves[std::string(point.metric)];
    curve["missions"].push_back(point.missions);
    curve["half_width"].push_back(Rounded(point.half_width));
    curve["half_width_missions"].push_back(Rounded(point.half_width_missions));
  }
  return curves;
}

}  // namespace ed3r::figures
