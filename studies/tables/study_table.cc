#include "studies/tables/study_table.h"

#include <fmt/format.h>

#include <utility>

#include "studies/metrics/arm.h"
#include "studies/paper/arms.h"
#include "studies/tables/data_files.h"
#include "studies/tables/names.h"

namespace ed3r::tables {
namespace {

struct Description {
  const char *id, *title;  // id: of the paper's comparison (paper/arms.h)
  bool arms_down;
  bool p85;  // the groups of its arms follow them
  std::vector<std::string_view> metrics;
};

const std::vector<Description>& Descriptions() {
  static const std::vector<Description> all = {
      {"thresholds",
       "ED³R at three detection thresholds (paper, Result 1)",
       false,
       false,
       {"total_energy_kj", "movement_energy_kj", "computation_energy_kj", "transmission_energy_kj",
        "sensing_energy_kj", "mscs_pct", "msr_pct", "wer_pct", "fp_pct", "bd_pct", "er_pct",
        "lf_accuracy_pct", "or_pct", "model_full_pct", "model_quant_pct", "duration_mean_min",
        "duration_max_min", "within_10min_pct"}},
      {"ablations",
       "ED³R and its ablations (paper, Result 2)",
       false,
       false,
       {"total_energy_kj", "movement_energy_kj", "computation_energy_kj", "transmission_energy_kj",
        "sensing_energy_kj", "mscs_pct", "msr_pct", "wer_pct", "fp_pct", "bd_pct", "lf_accuracy_pct",
        "or_pct", "model_full_pct", "model_quant_pct", "duration_mean_min"}},
      {"baselines",
       "ED³R against two baselines, all missions and the longest 15 % (P85) (paper, Result 3)",
       true,
       true,
       {"total_energy_kj", "mscs_pct", "msr_pct", "wer_pct", "lf_accuracy_pct", "duration_mean_min"}},
  };
  return all;
}

constexpr std::string_view kMainMetrics[] = {"total_energy_kj", "msr_pct",  "wer_pct",          "fp_pct",
                                             "bd_pct",          "mscs_pct", "duration_mean_min"};

// As the paper heads its columns; other metrics go by their label.
constexpr std::pair<std::string_view, std::string_view> kShortNames[] = {
    {"total_energy_kj", "energy"},
    {"movement_energy_kj", "movement energy"},
    {"computation_energy_kj", "computation energy"},
    {"transmission_energy_kj", "transmission energy"},
    {"sensing_energy_kj", "sensing energy"},
    {"mscs_pct", "MSCS"},
    {"msr_pct", "MSR"},
    {"wer_pct", "WER"},
    {"fp_pct", "FP"},
    {"bd_pct", "BD"},
    {"or_pct", "OR"},
    {"lf_accuracy_pct", "LF accuracy"},
    {"er_pct", "ER"},
    {"duration_mean_min", "duration"},
    {"duration_max_min", "longest mission"},
};

using Arms = std::vector<const metrics::ArmMetrics*>;

const metrics::ArmMetrics* Find(std::span<const metrics::ArmMetrics> arms, std::string_view stage,
                                std::string_view name) {
  for (const metrics::ArmMetrics& arm : arms)
    if (arm.stage == stage && arm.name == name && arm.missions > 0) return &arm;
  return nullptr;
}

// The named arms of the last stage that holds two of them at least, in the order of `names`.
Arms FindTogether(std::span<const metrics::ArmMetrics> arms, std::span<const std::string_view> names) {
  for (auto last = arms.rbegin(); last != arms.rend(); ++last) {
    Arms found;
    for (const std::string_view name : names)
      if (const metrics::ArmMetrics* arm = Find(arms, last->stage, name)) found.push_back(arm);
    if (found.size() >= 2) return found;
  }
  return {};
}

StudyTable MakeTable(const Description& description, const Arms& arms,
                     std::span<const metrics::ArmMetrics> p85) {
  StudyTable table{description.id, description.title, {}, description.arms_down, {}, {}, {}};
  for (const metrics::ArmMetrics* arm : arms) table.arms.push_back(*arm);
  if (description.p85)
    for (const metrics::ArmMetrics* arm : arms)
      if (const metrics::ArmMetrics* group = Find(p85, arm->stage, paper::P85Name(arm->name)))
        table.arms.push_back(*group);
  for (const metrics::ArmMetrics& arm : table.arms) table.labels.push_back(ArmLabel(arm.name));
  for (const std::string_view metric : description.metrics)
    table.metrics.push_back(metrics::MetricIndex(metric));
  std::vector<std::pair<std::string, double>> groups;
  for (std::size_t a = 0; a < table.arms.size(); ++a)
    if (paper::IsP85Name(table.arms[a].name))
      groups.emplace_back(table.labels[a], table.arms[a]["msr_pct"].value);
  if (!groups.empty()) table.note = P85Note(groups);
  return table;
}

// With the main metrics.
StudyTable TableOfAll(const char* id, const char* title, std::span<const metrics::ArmMetrics> arms) {
  StudyTable all{id, title, {}, true, {}, {}, {}};
  const std::vector<std::string> names = UniqueArmNames(arms);
  for (std::size_t a = 0; a < arms.size(); ++a) {
    if (arms[a].missions == 0) continue;
    all.arms.push_back(arms[a]);
    all.labels.push_back(ArmLabel(names[a]));
  }
  for (const std::string_view metric : kMainMetrics) all.metrics.push_back(metrics::MetricIndex(metric));
  return all;
}

}  // namespace

std::vector<StudyTable> MakeStudyTables(std::span<const metrics::ArmMetrics> arms,
                                        std::span<const metrics::ArmMetrics> p85) {
  StudyTable all = TableOfAll("arms", "Every arm", arms);
  std::vector<StudyTable> tables;
  if (!all.arms.empty()) tables.push_back(std::move(all));
  for (const Description& description : Descriptions())
    if (const Arms found = FindTogether(arms, paper::ArmsOfComparison(description.id)); !found.empty())
      tables.push_back(MakeTable(description, found, p85));
  return tables;
}

StudyTable MakeVariantsTable(std::span<const metrics::ArmMetrics> arms) {
  return TableOfAll("variants", "Every arm in every variant", arms);
}

std::string P85Note(std::span<const std::pair<std::string, double>> success) {
  std::vector<std::string> parts;
  for (const auto& [label, percent] : success) parts.push_back(fmt::format("{} {:.1f} %", label, percent));
  return fmt::format(
      "P85 is the longest {} % of each arm's own missions: arms are compared on different missions, chosen "
      "by "
      "their own result; the share of these that finds the fire: {}.",
      metrics::kP85Percent, fmt::join(parts, ", "));
}

std::string MetricHeading(std::size_t metric) {
  const metrics::MetricDefinition& definition = metrics::MetricDefinitions()[metric];
  std::string heading(definition.label);
  for (const auto& [name, short_name] : kShortNames)
    if (name == definition.name) heading = short_name;
  if (!definition.unit.empty()) heading.append(", ") += definition.unit;
  return heading;
}

}  // namespace ed3r::tables
