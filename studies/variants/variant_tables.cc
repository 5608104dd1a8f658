#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "studies/claims/verdict_tables.h"
#include "studies/metrics/definitions.h"
#include "studies/paper/csv.h"
#include "studies/tables/layout.h"
#include "studies/variants/variants.h"

namespace ed3r {
namespace {

constexpr int kArmWidth = 14, kVariantWidth = 26, kCellWidth = 26;
constexpr int kIdWidth = 5, kClaimWidth = 55;

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
  text += fmt::format("\n{}\n", Rule(kTerminalWidth));
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

std::string ChangeCounts(const VariantStudy& study) {
  std::string text;
  for (std::size_t v = 0; v < study.variants.size(); ++v) {
    text += fmt::format("{:>3} {}", v + 1, study.variants[v]);
    if (v > 0) {
      const auto here = [&](const VerdictChange& change) { return change.variant == study.variants[v]; };
      const auto contradicts = [&](const VerdictChange& change) {
        return here(change) && change.Contradicts();
      };
      text += fmt::format(": {} of {} claims, {} of them between 'holds' and 'differs'",
                          std::count_if(study.changes.begin(), study.changes.end(), here),
                          study.verdicts.front().claims.size(),
                          std::count_if(study.changes.begin(), study.changes.end(), contradicts));
    }
    text += "\n";
  }
  return text;
}

// Orders and comparisons that some variant judges otherwise, a row each; one letter per variant.
std::string ChangeMatrix(const VariantStudy& study) {
  std::string rows;
  int alike = 0;
  for (std::size_t i = 0; i < study.verdicts.front().claims.size(); ++i) {
    const Claim& claim = study.verdicts.front().claims[i].claim;
    if (claim.kind != "order" && claim.kind != "ratio") continue;
    const auto verdict = [&](std::size_t v) { return study.verdicts[v].claims[i].all.verdict; };
    std::string letters;
    bool changes = false;
    for (std::size_t v = 0; v < study.variants.size(); ++v) {
      letters += fmt::format("{:>3}", LetterOf(verdict(v)));
      changes |= verdict(v) != verdict(0);
    }
    if (!changes) {
      ++alike;
      continue;
    }
    rows += Pad(claim.id, kIdWidth, Align::kLeft) +
            Pad(ClaimInWords(claim, kClaimWidth - 1), kClaimWidth, Align::kLeft) + letters + "\n";
  }
  if (rows.empty()) return "";
  std::string heading =
      Pad("", kIdWidth, Align::kLeft) + Pad("orders and comparisons that change", kClaimWidth, Align::kLeft);
  for (std::size_t v = 0; v < study.variants.size(); ++v) heading += fmt::format("{:>3}", v + 1);
  return fmt::format("\n{}\n{}\n{}", heading, Rule(DisplayWidth(heading)), rows) +
         Wrap(fmt::format("{}. {} are judged alike in all; numbers: the table of verdicts.", kVerdictLetters,
                          alike),
              "", kTerminalWidth);
}

std::string ChangeTable(const VariantStudy& study) {
  if (!study.verdicts.front().HasArms()) return "";
  return fmt::format("\nClaims of the paper judged otherwise than under '{}'\n", study.variants[0]) +
         ChangeCounts(study) + ChangeMatrix(study);
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
  std::string csv = "claim,strategy,metric,kind,compared";
  for (const std::string& variant : study.variants) csv += fmt::format(",{}", CsvField(variant));
  csv += "\n";
  if (study.verdicts.empty()) return csv;
  for (std::size_t i = 0; i < study.verdicts.front().claims.size(); ++i) {
    const Claim& claim = study.verdicts.front().claims[i].claim;
    csv += fmt::format("{},{},{},{},{}", claim.id, CsvField(claim.strategy), claim.metric, claim.kind,
                       CsvField(claim.comparison));
    for (const ClaimStudy& verdicts : study.verdicts)
      csv += fmt::format(",{}", NameOf(verdicts.claims[i].all.verdict));
    csv += "\n";
  }
  return csv;
}

}  // namespace ed3r
