// The tables for papers and pages: each is described once, by its arms and metrics, and written as Markdown, LaTeX, CSV
// and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "studies/metrics/metrics.h"
#include "studies/paper/claims.h"

namespace ed3r::tables {

struct StudyTable {
  std::string id;                         // "baselines": file name, LaTeX label
  std::string title;                      // caption
  std::string note;                       // what its reader must know; mostly empty
  bool arms_down = true;                  // else metrics down, arms across
  std::vector<metrics::ArmMetrics> arms;  // P85 groups are arms of their own
  std::vector<std::string> labels;        // one per arm
  std::vector<std::size_t> metrics;       // of MetricDefinitions()
};

// Those of which the run has what they compare: "arms" (every arm, the main metrics), and per stage that holds them
// "thresholds" (ED³R at 65, 75 and 85 %), "ablations" (ED³R-75 and ablations 1 to 4) and "baselines" (ED³R-75, ECD²R and
// RBS, all missions and P85), each with two of its arms at least; of several such stages the last. `p85` holds the P85
// groups (P85Group) of the arms for which there is one. Arms without missions are left out.
std::vector<StudyTable> MakeStudyTables(std::span<const metrics::ArmMetrics> arms,
                                        std::span<const metrics::ArmMetrics> p85);

// "variants": every arm of every variant (ARM@VARIANT), the main metrics. Arms without missions are left out.
StudyTable MakeVariantsTable(std::span<const metrics::ArmMetrics> arms);

// What P85 groups are, of the arm labels and success rates (percent) given: "The longest 15 % of each arm's own missions, ...".
std::string P85Note(std::span<const std::pair<std::string, double>> success);

// "21.93 (19.85–23.95) [21.44]": ours, its 95 % interval, the paper's value; GitHub's pipe tables.
std::string MarkdownTable(const StudyTable& table, const std::vector<paper::Claim>& claims);

// A table environment for booktabs, label tab:ID; the paper's values are on lines of their own under ours.
std::string LatexTable(const StudyTable& table, const std::vector<paper::Claim>& claims);

// Columns stage,arm,missions,metric,unit,value,lo,hi,n,paper; full precision, none empty.
std::string CsvTable(const StudyTable& table, const std::vector<paper::Claim>& claims);

// {"id", "title", "note", "arms": [{"stage", "arm", "label", "missions", METRIC: {"mean", "lo", "hi", "n", "paper"}, ...}]}.
nlohmann::ordered_json JsonTable(const StudyTable& table, const std::vector<paper::Claim>& claims);

// Plain text as LaTeX prints it, the signs of the tables included (³ η ≥ –).
std::string LatexText(std::string_view utf8);

// Plain text within a Markdown cell.
std::string MarkdownText(std::string_view utf8);

// "MSR, %": the paper's short name of a metric with its unit, for a heading.
std::string MetricHeading(std::size_t metric);

}  // namespace ed3r::tables
