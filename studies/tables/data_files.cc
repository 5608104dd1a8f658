#include "studies/tables/data_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/core/files/csv_table.h"
#include "studies/metrics/number_text.h"
#include "studies/tables/paper_cell.h"

namespace ed3r::tables {
namespace {

using Json = nlohmann::ordered_json;

Json ValueJson(const metrics::MetricValue& ours) {
  return {{"mean", metrics::JsonNumber(ours.value)},
          {"lo", metrics::JsonNumber(ours.lo)},
          {"hi", metrics::JsonNumber(ours.hi)},
          {"n", ours.n}};
}

std::string ValueCsv(const metrics::MetricValue& ours) {
  return fmt::format("{},{},{},{}", metrics::CsvNumber(ours.value), metrics::CsvNumber(ours.lo),
                     metrics::CsvNumber(ours.hi), ours.n);
}

struct Place {
  const char* name;
  const metrics::ArmMetrics Generalisation::*missions;
};
constexpr Place kPlaces[] = {{"known-site", &Generalisation::known_sites},
                             {"unseen-site", &Generalisation::unseen_sites},
                             {"known-base-station", &Generalisation::known_stations},
                             {"unseen-base-station", &Generalisation::unseen_stations}};

}  // namespace

std::vector<std::string> UniqueArmNames(std::span<const metrics::ArmMetrics> arms) {
  std::map<std::string, int> uses;
  for (const metrics::ArmMetrics& arm : arms) ++uses[arm.name];
  std::vector<std::string> names;
  for (const metrics::ArmMetrics& arm : arms)
    names.push_back(uses[arm.name] == 1 ? arm.name : arm.stage + '/' + arm.name);
  return names;
}

Json ResultJson(std::span<const metrics::ArmMetrics> arms, const std::vector<paper::Claim>& claims) {
  const std::vector<std::string> names = UniqueArmNames(arms);
  Json all = Json::object();
  for (std::size_t a = 0; a < arms.size(); ++a) {
    const metrics::ArmMetrics& arm = arms[a];
    Json& entry = all[names[a]];
    entry = {
        {"stage", arm.stage}, {"missions", arm.missions}, {"failed", arm.failed}, {"missing", arm.missing}};
    for (std::size_t i = 0; i < arm.values.size(); ++i) {
      Json value = ValueJson(arm.values[i]);
      const PaperCell paper = MakePaperCell(claims, arm, i);
      value["paper"] = paper.value ? Json(paper.value->value) : Json(nullptr);
      entry[std::string(metrics::MetricDefinitions()[i].name)] = value;
    }
  }
  return {{"arms", all}};
}

std::string ResultCsv(std::span<const metrics::ArmMetrics> arms, const std::vector<paper::Claim>& claims) {
  std::string csv = "stage,arm,metric,value,lo,hi,n,paper\n";
  for (const metrics::ArmMetrics& arm : arms) {
    const std::string start = CsvField(arm.stage) + ',' + CsvField(arm.name) + ',';
    csv += fmt::format("{0}missions,{1},,,{1},\n{0}failed,{2},,,{1},\n{0}missing,{3},,,{1},\n", start,
                       arm.missions, arm.failed, arm.missing);
    for (std::size_t i = 0; i < arm.values.size(); ++i) {
      const PaperCell paper = MakePaperCell(claims, arm, i);
      csv += fmt::format("{}{},{},{}\n", start, metrics::MetricDefinitions()[i].name, ValueCsv(arm.values[i]),
                         paper.value ? paper.value->printed : "");
    }
  }
  return csv;
}

std::string GeneralisationCsv(std::span<const Generalisation> arms) {
  std::string csv = "stage,arm,place,metric,value,lo,hi,n\n";
  for (const Generalisation& arm : arms)
    for (const Place& place : kPlaces) {
      const metrics::ArmMetrics& missions = arm.*place.missions;
      for (std::size_t i = 0; i < missions.values.size(); ++i)
        csv += fmt::format("{},{},{},{},{}\n", CsvField(missions.stage), CsvField(missions.name), place.name,
                           metrics::MetricDefinitions()[i].name, ValueCsv(missions.values[i]));
    }
  return csv;
}

Json GeneralisationJson(std::span<const Generalisation> arms) {
  std::vector<metrics::ArmMetrics> known;
  for (const Generalisation& arm : arms) known.push_back(arm.known_sites);
  const std::vector<std::string> names = UniqueArmNames(known);
  Json all = Json::object();
  for (std::size_t a = 0; a < arms.size(); ++a)
    for (const Place& place : kPlaces) {
      const metrics::ArmMetrics& missions = arms[a].*place.missions;
      Json& entry = all[names[a]][place.name];
      entry = {{"missions", missions.missions}};
      for (std::size_t i = 0; i < missions.values.size(); ++i)
        entry[std::string(metrics::MetricDefinitions()[i].name)] = ValueJson(missions.values[i]);
    }
  return all;
}

}  // namespace ed3r::tables
