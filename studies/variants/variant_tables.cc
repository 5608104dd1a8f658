#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "studies/metrics/definitions.h"
#include "studies/paper/csv.h"
#include "studies/tables/layout.h"
#include "studies/variants/variants.h"

namespace ed3r {
namespace {

constexpr int kArmWidth = 14, kVariantWidth = 26, kCellWidth = 26;

std::string CellText(const VariantDifference& d) {
  if (std::isnan(d.difference)) return "–";
  return fmt::format("{:+.1f}{} [{:+.1f}, {:+.1f}]", d.difference,
                     d.Certain()      ? "*"
                     : d.OneNetwork() ? "?"
                                      : "",
                     d.lo, d.hi);
}

std::string DifferenceTable(const VariantStudy& study) {
  const auto heading = [](const char* metric) {
    const MetricDefinition& definition = MetricDefinitions()[MetricIndex(metric)];
    return fmt::format("{}, {}", definition.label, definition.unit);
  };
  std::string text =
      fmt::format("Variants minus '{}', paired by scenario (* interval without 0)\n", study.variants[0]);
  text += Pad("arm", kArmWidth, Align::kLeft) + Pad("variant", kVariantWidth, Align::kLeft);
  for (const char* metric : kComparedMetrics) text += Pad(heading(metric), kCellWidth, Align::kRight);
  text += "\n" + Rule(kTerminalWidth) + "\n";
  constexpr std::size_t kMetrics = std::size(kComparedMetrics);
  for (std::size_t i = 0; i < study.differences.size(); i += kMetrics) {
    const VariantDifference& first = study.differences[i];
    text += Pad(first.arm, kArmWidth, Align::kLeft) + Pad(first.variant, kVariantWidth, Align::kLeft);
    for (std::size_t m = 0; m < kMetrics; ++m)
      text += Pad(CellText(study.differences[i + m]), kCellWidth, Align::kRight);
    text += "\n";
  }
  if (std::any_of(study.differences.begin(), study.differences.end(),
                  [](const VariantDifference& d) { return d.OneNetwork(); }))
    text += Wrap("one trained network on a side: the luck of training is not in the interval.", "? ",
                 kTerminalWidth);
  return text;
}

std::string ChangeTable(const VariantStudy& study) {
  if (!study.verdicts.front().HasArms()) return "";
  std::string text =
      fmt::format("\nClaims of the paper judged otherwise than under '{}'\n", study.variants[0]);
  for (std::size_t v = 1; v < study.variants.size(); ++v) {
    std::string line;
    int count = 0, contradictions = 0;
    for (const VerdictChange& change : study.changes) {
      if (change.variant != study.variants[v]) continue;
      line += fmt::format("{}{}: {} -> {}", count++ > 0 ? "; " : "", change.claim, NameOf(change.base),
                          NameOf(change.here));
      contradictions += change.Contradicts() ? 1 : 0;
    }
    text += fmt::format("{}: {} of {} claims, {} of them between 'holds' and 'differs'\n", study.variants[v],
                        count, study.verdicts.front().claims.size(), contradictions);
    if (count > 0) text += Wrap(line, "  ", kTerminalWidth);
  }
  return text;
}

}  // namespace

std::string VariantText(const VariantStudy& study) {
  if (study.variants.empty()) return "";
  return DifferenceTable(study) + ChangeTable(study);
}

std::string DifferenceCsv(const VariantStudy& study) {
  std::string csv = "arm,variant,metric,base,difference,lo,hi,pairs,base_networks,networks\n";
  for (const VariantDifference& d : study.differences)
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", CsvField(d.arm), CsvField(d.variant), d.metric,
                       d.base, d.difference, d.lo, d.hi, d.pairs, d.base_networks, d.networks);
  return csv;
}

std::string VariantVerdictCsv(const VariantStudy& study) {
  std::string csv = "claim";
  for (const std::string& variant : study.variants) csv += fmt::format(",{}", CsvField(variant));
  csv += "\n";
  if (study.verdicts.empty()) return csv;
  for (std::size_t i = 0; i < study.verdicts.front().claims.size(); ++i) {
    csv += study.verdicts.front().claims[i].claim.id;
    for (const ClaimStudy& verdicts : study.verdicts)
      csv += fmt::format(",{}", NameOf(verdicts.claims[i].all.verdict));
    csv += "\n";
  }
  return csv;
}

}  // namespace ed3r
