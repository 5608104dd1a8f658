#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "studies/tables/result_table.h"

namespace ed3r::tables {
namespace {

constexpr int kLabelWidth = 26, kCountWidth = 8, kColumnWidth = 20;

struct Column {
  std::string_view metric, title;
  int decimals;
};
constexpr Column kColumns[] = {{"total_energy_kj", "energy, kJ", 1},
                               {"msr_pct", "MSR, %", 1},
                               {"wer_pct", "WER, %", 1},
                               {"mscs_pct", "MSCS, %", 1}};

std::string CellText(const metrics::MetricValue& ours, int decimals) {
  const std::string value = Pad(FormatValue(ours.value, decimals), 7, Align::kRight);
  if (std::isnan(ours.lo)) return Pad(value, kColumnWidth, Align::kLeft);
  const std::string interval =
      fmt::format("  {}–{}", FormatValue(ours.lo, decimals), FormatValue(ours.hi, decimals));
  return Pad(value + interval, kColumnWidth, Align::kLeft);
}

std::string Line(std::string_view label, const metrics::ArmMetrics& missions) {
  std::string line = Pad(fmt::format("  {}", label), kLabelWidth, Align::kLeft) +
                     Pad(std::to_string(missions.missions), kCountWidth, Align::kRight);
  for (const Column& column : kColumns) line += CellText(missions[column.metric], column.decimals);
  return line + '\n';
}

bool HasUnseen(const Generalisation& arm) {
  return arm.unseen_sites.missions > 0 || arm.unseen_stations.missions > 0;
}

}  // namespace

Generalisation ComputeGeneralisation(const metrics::ArmData& arm) {
  const metrics::KnownUnseen sites = metrics::Split(arm, metrics::SplitBy::kSite);
  const metrics::KnownUnseen stations = metrics::Split(arm, metrics::SplitBy::kBaseStation);
  return {metrics::ComputeMetrics(sites.known), metrics::ComputeMetrics(sites.unseen),
          metrics::ComputeMetrics(stations.known), metrics::ComputeMetrics(stations.unseen)};
}

std::string GeneralisationTable(std::span<const Generalisation> arms) {
  if (std::none_of(arms.begin(), arms.end(), HasUnseen)) return "";
  std::string table = "Places that the warm-up had seen, and others (95 % intervals)\n\n";
  table += std::string(kLabelWidth, ' ') + Pad("missions", kCountWidth, Align::kRight);
  for (const Column& column : kColumns)
    table += Pad("   " + std::string(column.title), kColumnWidth, Align::kLeft);
  table +=
      '\n' + Rule(kLabelWidth + kCountWidth + kColumnWidth * static_cast<int>(std::size(kColumns))) + '\n';
  for (const Generalisation& arm : arms) {
    if (!HasUnseen(arm)) continue;
    table += arm.known_sites.name + '\n' + Line("fire site known", arm.known_sites) +
             Line("fire site unseen", arm.unseen_sites) + Line("base station known", arm.known_stations) +
             Line("base station unseen", arm.unseen_stations);
  }
  return TrimLineEnds(table);
}

}  // namespace ed3r::tables
