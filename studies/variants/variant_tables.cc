#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/core/files/csv_table.h"
#include "engine/sweep/arm_id.h"
#include "studies/claims/verdict_tables.h"
#include "studies/tables/data_files.h"
#include "studies/tables/layout.h"
#include "studies/variants/difference_text.h"
#include "studies/variants/variants.h"

namespace ed3r::variants {
namespace {

constexpr int kLeastArmWidth = 14, kLeastVariantWidth = 26, kCellWidth = 26;
constexpr int kIdWidth = 5, kFewestWords = 24, kMostWords = 60;

// The columns that name a row of a table, and the table's heading under them.
struct RowNames {
  tables::TextColumn arm, variant;

  RowNames(const std::vector<std::string>& arms, const std::vector<std::string>& variants)
      : arm(arms, kLeastArmWidth), variant(variants, kLeastVariantWidth) {}

  std::string Of(const std::string& arm_name, const std::string& variant_name) const {
    return arm(arm_name) + variant(variant_name);
  }

  std::string Heading() const {
    std::string text = Of("arm", "variant");
    for (const char* metric : kComparedMetrics)
      text += tables::Pad(DifferenceHeading(metric), kCellWidth, tables::Align::kRight);
    return fmt::format("{}\n{}\n", text,
                       tables::Rule(std::max(tables::kTerminalWidth, tables::DisplayWidth(text))));
  }
};

RowNames NamesOf(const std::vector<VariantDifference>& differences) {
  std::vector<std::string> arms, variants;
  for (const VariantDifference& difference : differences) {
    arms.push_back(difference.arm);
    variants.push_back(difference.variant);
  }
  return {arms, variants};
}

RowNames NamesOf(std::span<const metrics::ArmMetrics> metrics) {
  std::vector<std::string> arms, variants;
  for (const std::string& name : tables::UniqueArmNames(metrics)) {
    const sweep::ArmId id = sweep::ArmId::Of(name);
    arms.push_back(id.name);
    variants.push_back(id.variant);
  }
  return {arms, variants};
}

std::string DifferenceTable(const VariantStudy& study) {
  std::string text =
      fmt::format("Variants minus '{}', {} (* interval without 0)\n", study.variants[0],
                  study.same_draws ? "paired by scenario" : "of other seeds: other draws at the same places");
  const RowNames names = NamesOf(study.differences);
  text += names.Heading();
  constexpr std::size_t kMetrics = std::size(kComparedMetrics);
  for (std::size_t i = 0; i < study.differences.size(); i += kMetrics) {
    const VariantDifference& first = study.differences[i];
    text += names.Of(first.arm, first.variant);
    for (std::size_t m = 0; m < kMetrics; ++m)
      text += tables::Pad(DifferenceCell(study.differences[i + m], study.differences[i + m].Certain()),
                          kCellWidth, tables::Align::kRight);
    text += "\n";
  }
  if (std::any_of(study.differences.begin(), study.differences.end(),
                  [](const VariantDifference& d) { return d.OneNetwork(); }))
    text += tables::Wrap(kOneNetworkNote, "? ", tables::kTerminalWidth);
  const auto intervals = std::count_if(study.differences.begin(), study.differences.end(),
                                       [](const auto& d) { return !std::isnan(d.lo) && !d.OneNetwork(); });
  const auto stars = std::count_if(study.differences.begin(), study.differences.end(),
                                   [](const VariantDifference& d) { return d.Certain(); });
  return text +
         tables::Wrap(
             fmt::format(
                 "{} of {} intervals have a star; each is 95 % by itself, so that about {:.0f} would by "
                 "chance (the three of an arm go together).",
                 stars, intervals, std::ceil(0.05 * static_cast<double>(intervals))),
             "", tables::kTerminalWidth);
}

std::string ValueCell(const metrics::MetricValue& value) {
  if (std::isnan(value.lo)) return tables::FormatValue(value.value, 1);
  return fmt::format("{} [{}, {}]", tables::FormatValue(value.value, 1), tables::FormatValue(value.lo, 1),
                     tables::FormatValue(value.hi, 1));
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
      text += fmt::format(": {} of {} claims, {} of them between 'holds' and 'differs beyond luck'",
                          std::count_if(study.changes.begin(), study.changes.end(), here),
                          study.verdicts.front().claims.size(),
                          std::count_if(study.changes.begin(), study.changes.end(), contradicts));
    }
    text += "\n";
  }
  return text;
}

// Every changed verdict, of two variants.
std::string ChangeList(const VariantStudy& study) {
  if (study.variants.size() != 2 || study.changes.empty()) return "";
  constexpr int kVerdictWidth = 20, kWords = tables::kTerminalWidth - kIdWidth - 2 * kVerdictWidth;
  std::string text;
  for (std::size_t i = 0; i < study.verdicts.front().claims.size(); ++i) {
    const claims::JudgedClaim& before = study.verdicts.front().claims[i];
    const claims::JudgedClaim& after = study.verdicts.back().claims[i];
    if (before.all.verdict == after.all.verdict) continue;
    text += tables::Pad(before.claim.id, kIdWidth, tables::Align::kLeft) +
            tables::Pad(claims::ClaimInWords(before.claim, kWords - 1), kWords, tables::Align::kLeft) +
            tables::Pad(claims::NameWithLuck(before), kVerdictWidth, tables::Align::kLeft) +
            claims::NameWithLuck(after) + "\n";
  }
  return fmt::format("\n{}{}{}{}\n{}\n{}", tables::Pad("", kIdWidth, tables::Align::kLeft),
                     tables::Pad("changed verdicts", kWords, tables::Align::kLeft),
                     tables::Pad("1", kVerdictWidth, tables::Align::kLeft), "2",
                     tables::Rule(tables::kTerminalWidth), text);
}

// Which side the evidence is on, of one claim alone: a few networks cannot pass Holm's correction over all claims.
char SideOf(const claims::Judgement& judged) {
  constexpr double kLevel = 0.05;
  if (judged.verdict == claims::Verdict::kNotMeasured) return ' ';
  return judged.p < kLevel ? '+' : judged.p_against < kLevel ? '-' : '.';
}

// Orders and comparisons on which the evidence changes sides, a row each; one sign per variant.
std::string ChangeMatrix(const VariantStudy& study) {
  const int width =
      std::clamp(tables::kTerminalWidth - kIdWidth - 3 * static_cast<int>(study.variants.size()),
                 kFewestWords, kMostWords);
  std::string rows;
  int alike = 0;
  for (std::size_t i = 0; i < study.verdicts.front().claims.size(); ++i) {
    const paper::Claim& claim = study.verdicts.front().claims[i].claim;
    if (claim.kind != "order" && claim.kind != "ratio") continue;
    const auto side = [&](std::size_t v) { return SideOf(study.verdicts[v].claims[i].all); };
    std::string signs;
    bool changes = false;
    for (std::size_t v = 0; v < study.variants.size(); ++v) {
      signs += fmt::format("{:>3}", side(v));
      changes |= side(v) != side(0);
    }
    if (!changes) {
      ++alike;
      continue;
    }
    rows += tables::Pad(claim.id, kIdWidth, tables::Align::kLeft) +
            tables::Pad(claims::ClaimInWords(claim, width - 1), width, tables::Align::kLeft) + signs + "\n";
  }
  if (rows.empty()) return "";
  std::string heading = tables::Pad("", kIdWidth, tables::Align::kLeft) +
                        tables::Pad("sides of orders and comparisons", width, tables::Align::kLeft);
  for (std::size_t v = 0; v < study.variants.size(); ++v) heading += fmt::format("{:>3}", v + 1);
  return fmt::format("\n{}\n{}\n{}", heading, tables::Rule(tables::DisplayWidth(heading)), rows) +
         tables::Wrap(
             fmt::format(
                 "+ as claimed, - the opposite (p < 0.05, paired, of this claim alone, not corrected for the "
                 "number of claims), . neither. {} more are alike in all.",
                 alike),
             "", tables::kTerminalWidth);
}

// In how many variants a claim holds, of those that measure it.
struct Tally {
  int holds = 0, measured = 0;
};

Tally TallyOf(const VariantStudy& study, std::size_t claim) {
  Tally tally;
  for (const claims::ClaimStudy& verdicts : study.verdicts) {
    const claims::Verdict verdict = verdicts.claims[claim].all.verdict;
    tally.measured += verdict != claims::Verdict::kNotMeasured;
    tally.holds += claims::Holds(verdict);
  }
  return tally;
}

// Predicted claims that hold in every variant, and those that hold in none.
std::string Everywhere(const VariantStudy& study) {
  std::string in_all, in_none;
  int all = 0, none = 0, counted = 0;
  for (std::size_t i = 0; i < study.verdicts.front().claims.size(); ++i) {
    const claims::JudgedClaim& judged = study.verdicts.front().claims[i];
    const Tally tally = TallyOf(study, i);
    const bool built = judged.claim.kind == "setup" || judged.claim.source == "construction";
    if (built || !judged.repeats.empty() || tally.measured < static_cast<int>(study.variants.size()))
      continue;
    ++counted;
    const std::string line = tables::Pad(judged.claim.id, kIdWidth + 1, tables::Align::kLeft) +
                             claims::ClaimInWords(judged.claim, tables::kTerminalWidth - kIdWidth - 1) + "\n";
    if (tally.holds == tally.measured) in_all += line, ++all;
    if (tally.holds == 0) in_none += line, ++none;
  }
  if (counted == 0) return "";
  return fmt::format("\n{} of {} distinct claims hold in every variant:\n{}\n{} hold in none:\n{}", all,
                     counted, in_all, none, in_none);
}

std::string ChangeTable(const VariantStudy& study) {
  if (study.verdicts.empty() || !study.verdicts.front().HasArms()) return "";
  return fmt::format("\nClaims of the paper judged otherwise than under '{}'\n", study.variants[0]) +
         ChangeCounts(study) + ChangeList(study) + ChangeMatrix(study) + Everywhere(study);
}

}  // namespace

std::string VariantValuesText(std::span<const metrics::ArmMetrics> arms) {
  const RowNames names = NamesOf(arms);
  std::string text = "All variants (95 % intervals)\n" + names.Heading();
  const std::vector<std::string> unique = tables::UniqueArmNames(arms);
  for (std::size_t a = 0; a < arms.size(); ++a) {
    if (arms[a].missions == 0) continue;
    const sweep::ArmId id = sweep::ArmId::Of(unique[a]);
    text += names.Of(id.name, id.variant);
    for (const char* metric : kComparedMetrics)
      text += tables::Pad(ValueCell(arms[a][metric]), kCellWidth, tables::Align::kRight);
    text += "\n";
  }
  return text;
}

std::string VariantText(const VariantStudy& study) {
  if (study.variants.empty()) return "";
  return DifferenceTable(study) + ChangeTable(study);
}

std::string DifferenceCsv(const VariantStudy& study) {
  std::string csv = "arm,variant,metric,base,difference,lo,hi,pairs,base_networks,networks\n";
  const auto number = [](double x) { return std::isnan(x) ? "" : fmt::format("{}", x); };
  for (const VariantDifference& d : study.differences)
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", CsvField(d.arm), CsvField(d.variant), d.metric,
                       number(d.base), number(d.difference), number(d.lo), number(d.hi), d.pairs,
                       d.base_networks, d.networks);
  return csv;
}

std::string VariantVerdictCsv(const VariantStudy& study) {
  std::string csv = "claim,strategy,metric,kind,compared,holds,variants";
  for (const std::string& variant : study.variants) csv += fmt::format(",{}", CsvField(variant));
  csv += "\n";
  if (study.verdicts.empty()) return csv;
  for (std::size_t i = 0; i < study.verdicts.front().claims.size(); ++i) {
    const paper::Claim& claim = study.verdicts.front().claims[i].claim;
    const Tally tally = TallyOf(study, i);
    csv += fmt::format("{},{},{},{},{},{},{}", claim.id, CsvField(claim.strategy), claim.metric, claim.kind,
                       CsvField(claim.comparison), tally.holds, tally.measured);
    for (const claims::ClaimStudy& verdicts : study.verdicts)
      csv += fmt::format(",{}", claims::NameWithLuck(verdicts.claims[i]));
    csv += "\n";
  }
  return csv;
}

}  // namespace ed3r::variants
