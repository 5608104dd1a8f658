#include "studies/variants/arm_differences.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "engine/core/files/csv_table.h"
#include "studies/metrics/number_text.h"
#include "studies/statistics/holm.h"
#include "studies/tables/layout.h"
#include "studies/variants/difference_text.h"
#include "studies/variants/pairing_notes.h"

namespace ed3r::variants {
namespace {

constexpr std::string_view kReferenceArm = "rbs";
constexpr std::size_t kMetrics = std::size(kComparedMetrics);
constexpr int kLeastArmWidth = 20, kPairsWidth = 7, kCellWidth = 31;

// What the other arms of its stage are compared with; null where none has flown.
const metrics::ArmData* ReferenceOf(std::span<const metrics::ArmData> arms, const std::string& stage,
                                    std::string_view wanted) {
  const metrics::ArmData* reference = nullptr;
  for (const metrics::ArmData& arm : arms) {
    if (arm.stage != stage || arm.missions.empty()) continue;
    if (arm.name == (wanted.empty() ? kReferenceArm : wanted)) return &arm;
    if (reference == nullptr && wanted.empty()) reference = &arm;
  }
  return reference;
}

void Correct(std::vector<ArmDifference>& differences) {
  std::vector<double> p;
  for (const ArmDifference& d : differences)
    if (!std::isnan(d.p)) p.push_back(d.p);
  const std::vector<double> adjusted = statistics::HolmAdjust(p);
  auto next = adjusted.begin();
  for (ArmDifference& d : differences) d.p_holm = std::isnan(d.p) ? d.p : *next++;
}

// Rows of one stage, from `first` on; `first` is then behind them.
std::string StageTable(std::span<const ArmDifference> differences, std::size_t& first) {
  const std::string &stage = differences[first].stage, &minus = differences[first].minus;
  std::string text = fmt::format("{}: arms minus '{}', paired by scenario\n", stage, minus);
  std::vector<std::string> names;
  for (const ArmDifference& difference : differences) names.push_back(difference.arm);
  const tables::TextColumn arm(names, kLeastArmWidth);
  std::string heading = arm("arm") + tables::Pad("pairs", kPairsWidth, tables::Align::kRight);
  for (const char* metric : kComparedMetrics)
    heading += tables::Pad(DifferenceHeading(metric), kCellWidth, tables::Align::kRight);
  text += fmt::format("{}\n{}\n", heading,
                      tables::Rule(std::max(tables::kTerminalWidth, tables::DisplayWidth(heading))));
  for (; first < differences.size() && differences[first].stage == stage; first += kMetrics) {
    text += arm(differences[first].arm) +
            tables::Pad(fmt::format("{}", differences[first].pairs), kPairsWidth, tables::Align::kRight);
    for (std::size_t m = 0; m < kMetrics; ++m) {
      const ArmDifference& d = differences[first + m];
      text += tables::Pad(DifferenceCell(d, d.Certain()) + " p " + PText(d.p_holm), kCellWidth,
                          tables::Align::kRight);
    }
    text += "\n";
  }
  return text;
}

}  // namespace

std::vector<ArmDifference> CompareArms(std::span<const metrics::ArmData> arms,
                                       std::string_view reference_name) {
  std::vector<ArmDifference> differences;
  for (const metrics::ArmData& arm : arms) {
    const metrics::ArmData* reference = ReferenceOf(arms, arm.stage, reference_name);
    if (reference == nullptr || &arm == reference || !SameScenarios(*reference, arm)) continue;
    for (const char* metric : kComparedMetrics) {
      const PairedDifference difference = DifferenceOf(*reference, arm, metric);
      if (difference.pairs > 0)
        differences.push_back({difference, arm.stage, arm.name, reference->name, metric});
    }
  }
  Correct(differences);
  return differences;
}

std::vector<std::string> ArmPairingNotes(std::span<const metrics::ArmData> arms) {
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> left_out, other_worlds,
      few;  // by stage, reference
  for (const metrics::ArmData& arm : arms) {
    const metrics::ArmData* const reference = ReferenceOf(arms, arm.stage, {});
    if (reference == nullptr || &arm == reference) continue;
    const std::pair key(arm.stage, reference->name);
    if (!SameScenarios(*reference, arm))
      left_out[key].push_back(arm.name);
    else if (OtherWorlds(*reference, arm))
      other_worlds[key].push_back(arm.name);
    if (FewInCommon(*reference, arm))
      few[key].push_back(
          fmt::format("{} ({} of {})", arm.name, ScenariosInCommon(*reference, arm), arm.missions.size()));
  }
  std::vector<std::string> notes;
  for (const auto& [key, names] : left_out)
    notes.push_back(
        fmt::format("{}: not compared with '{}' are {}, whose scenarios of one number begin elsewhere or "
                    "look for another fire.",
                    key.first, key.second, fmt::join(names, ", ")));
  for (const auto& [key, names] : few)
    notes.push_back(
        fmt::format("{}: not all scenario numbers are those of '{}' (mission.first_scenario), compared are "
                    "those in common: {}.",
                    key.first, key.second, fmt::join(names, ", ")));
  for (const auto& [key, names] : other_worlds)
    for (std::string& note : PlaceNotes({}, names, key.second)) notes.push_back(std::move(note));
  return notes;
}

std::string ArmDifferenceText(std::span<const ArmDifference> differences) {
  std::string text;
  for (std::size_t first = 0; first < differences.size();) text += StageTable(differences, first);
  if (text.empty()) return text;
  const auto tested = std::count_if(differences.begin(), differences.end(),
                                    [](const ArmDifference& d) { return !std::isnan(d.p); });
  text += tables::Wrap(
      fmt::format("intervals of 95 %; p and * (below 0.05) after Holm's correction for all {}.", tested), "",
      tables::kTerminalWidth);
  if (std::any_of(differences.begin(), differences.end(),
                  [](const ArmDifference& d) { return d.OneNetwork(); }))
    text += tables::Wrap(kOneNetworkNote, "? ", tables::kTerminalWidth);
  return text;
}

std::string ArmDifferenceCsv(std::span<const ArmDifference> differences) {
  std::string csv = "stage,arm,minus,metric,base,difference,lo,hi,p,p_holm,pairs,base_networks,networks\n";
  for (const ArmDifference& d : differences) {
    csv += fmt::format("{},{},{},{}", CsvField(d.stage), CsvField(d.arm), CsvField(d.minus), d.metric);
    for (const double value : {d.base, d.difference, d.lo, d.hi, d.p, d.p_holm})
      csv += ',' + metrics::CsvNumber(value);
    csv += fmt::format(",{},{},{}\n", d.pairs, d.base_networks, d.networks);
  }
  return csv;
}

nlohmann::ordered_json ArmDifferenceJson(std::span<const ArmDifference> differences) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ArmDifference& d : differences)
    list.push_back({{"stage", d.stage},
                    {"arm", d.arm},
                    {"minus", d.minus},
                    {"metric", d.metric},
                    {"base", metrics::JsonNumber(d.base)},
                    {"difference", metrics::JsonNumber(d.difference)},
                    {"lo", metrics::JsonNumber(d.lo)},
                    {"hi", metrics::JsonNumber(d.hi)},
                    {"p", metrics::JsonNumber(d.p)},
                    {"p_holm", metrics::JsonNumber(d.p_holm)},
                    {"certain", d.Certain()},
                    {"pairs", d.pairs},
                    {"base_networks", d.base_networks},
                    {"networks", d.networks}});
  return list;
}

}  // namespace ed3r::variants
