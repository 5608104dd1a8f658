#include "studies/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/store/checksums.h"
#include "studies/claims/verdict_tables.h"
#include "studies/paper/arms.h"
#include "studies/paper/claims.h"
#include "studies/tables/data_files.h"
#include "studies/tables/layout.h"
#include "studies/variants/pairing_notes.h"

namespace ed3r::report {
namespace {

namespace fs = std::filesystem;

// Whether nothing that departs keeps the claims of this variant from being judged.
bool MayJudge(const Report& report, const std::string& variant) {
  const auto found = report.departures.find(variant);
  return report.judging == Judging::kEverything || found == report.departures.end() ||
         found->second.PaperFlown();
}

bool MayJudgeAll(const Report& report) {
  return std::all_of(report.departures.begin(), report.departures.end(),
                     [&](const auto& entry) { return MayJudge(report, entry.first); });
}

// The number of the variant that is told.
std::size_t TheVariant(const Report& report) {
  const std::vector<std::string>& names = report.variants.variants;
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), report.variant) - names.begin());
}

std::string ChosenVariant(const std::vector<std::string>& names, const std::string& wanted) {
  if (wanted.empty()) return names.empty() ? "" : names.front();
  if (names.empty())
    throw UserError(fmt::format("--variant: '{}' is not allowed; the run has no variants", wanted));
  if (std::find(names.begin(), names.end(), wanted) == names.end())
    throw UserError(
        fmt::format("--variant: '{}' is not allowed; allowed: {}", wanted, fmt::join(names, ", ")));
  return wanted;
}

claims::ClaimStudy ClaimsOf(const Report& report, const std::vector<metrics::ArmData>& arms) {
  if (!report.variants.verdicts.empty()) return report.variants.verdicts[TheVariant(report)];
  if (MayJudge(report, report.variant)) return claims::JudgeClaims(paper::PaperClaims(), arms);
  claims::ClaimStudy unjudged;
  for (const metrics::ArmMetrics& arm : report.told)
    unjudged.networks = std::max(unjudged.networks, arm.networks);
  return unjudged;
}

// The arms of the stages that no verdicts compare: with an arm that the paper does not have, or any where none are judged.
std::vector<metrics::ArmData> Uncompared(const claims::ClaimStudy& claims,
                                         const std::vector<metrics::ArmData>& arms) {
  std::vector<metrics::ArmData> uncompared;
  for (const metrics::ArmData& arm : arms)
    if (claims.claims.empty() || std::any_of(arms.begin(), arms.end(), [&](const metrics::ArmData& other) {
          return other.stage == arm.stage && paper::FindPaperArm(other.name) == nullptr;
        }))
      uncompared.push_back(arm);
  return uncompared;
}

// Which missions are in a P85 group is itself chance, and so is what networks they come from: the claims' resampling forms
// the groups anew each time, the tables' formulas know only the group at hand.
void TakeP85Intervals(const claims::ClaimStudy& claims, std::vector<metrics::ArmMetrics>& p85) {
  for (metrics::ArmMetrics& group : p85)
    for (const claims::JudgedClaim& judged : claims.claims) {
      if (judged.claim.strategy != group.name || judged.claim.kind != "value" || std::isnan(judged.all.lo))
        continue;
      const auto metric =
          std::find_if(metrics::MetricDefinitions().begin(), metrics::MetricDefinitions().end(),
                       [&](const metrics::MetricDefinition& m) { return m.name == judged.claim.metric; });
      if (metric == metrics::MetricDefinitions().end()) continue;
      metrics::MetricValue& value =
          group.values[static_cast<std::size_t>(metric - metrics::MetricDefinitions().begin())];
      // Of a stage of the same names that the claims do not speak of, it is another group.
      if (std::abs(value.value - judged.all.ours) > 1e-6 * std::abs(value.value)) continue;
      value.lo = judged.all.lo, value.hi = judged.all.hi;
    }
}

}  // namespace

std::vector<std::string> Report::DepartureNotes() const {
  return DepartureSentences(departures, variant, judging);
}

std::string ToldVariant(const RunResults& results, const std::string& wanted) {
  return ChosenVariant(variants::VariantsOf(results.arms), wanted);
}

std::string VariantNote(const Report& report) {
  if (report.variants.variants.size() < 2) return "";
  return fmt::format(
      "Told here: the variant '{}', number {} of {}. The table of all variants tells the others in short, "
      "'ed3r report DIR "
      "--variant NAME' one of them as a whole.",
      report.variant, TheVariant(report) + 1, report.variants.variants.size());
}

Report MakeReport(const RunResults& results, const RunDepartures& departures, Judging judging,
                  const std::string& variant) {
  Report report;
  report.name = results.name;
  report.mixed_code = results.mixed_code;
  report.unchecked = results.unchecked;
  report.departures = departures;
  report.judging = judging;
  report.variants = variants::CompareVariants(
      results.arms, MayJudgeAll(report) ? variants::Verdicts::kJudged : variants::Verdicts::kLeftOut);
  report.variant = ToldVariant(results, variant);
  const bool variants = !report.variants.variants.empty();
  const std::vector<metrics::ArmData> chosen =
      variants ? variants::ArmsOfVariant(results.arms, report.variant) : std::vector<metrics::ArmData>();
  const std::vector<metrics::ArmData>& arms = variants ? chosen : results.arms;
  for (const metrics::ArmData& arm : results.arms) report.arms.push_back(metrics::ComputeMetrics(arm));
  std::vector<metrics::ArmMetrics> p85;
  for (const metrics::ArmData& arm : arms) {
    if (variants) report.told.push_back(metrics::ComputeMetrics(arm));
    report.generalisation.push_back(tables::ComputeGeneralisation(arm));
    p85.push_back(metrics::ComputeP85(arm));
  }
  if (!variants) report.told = report.arms;
  report.claims = ClaimsOf(report, arms);
  report.differences = variants::CompareArms(Uncompared(report.claims, arms));
  report.difference_notes = variants::ArmPairingNotes(Uncompared(report.claims, arms));
  report.variant_notes = variants::VariantPairingNotes(results.arms);
  report.convergence = claims::Convergence(arms);
  report.look_forward = tables::LookForwardOf(arms);
  TakeP85Intervals(report.claims, p85);
  report.tables = tables::MakeStudyTables(report.told, p85);
  if (report.variants.variants.size() > 1) report.tables.push_back(tables::MakeVariantsTable(report.arms));
  if (!report.claims.HasArms())
    for (tables::StudyTable& table : report.tables)
      if (!table.note.empty())
        table.note +=
            " Intervals of P85 are too narrow: over the missions of the group at hand, not over which fall "
            "into it.";
  return report;
}

namespace {

std::string Paragraphs(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += tables::Wrap(note, "", tables::kTerminalWidth);
  return text;
}

}  // namespace

std::string ReportText(const Report& report) {
  std::string text = report.name;
  if (!report.mixed_code.empty()) text += fmt::format(", MIXED CODE (--accept-mixed): {}", report.mixed_code);
  if (report.unchecked) text += fmt::format(", {}", store::kNothingToCompare);
  if (report.arms.empty()) return text + "\n\nNo missions.\n";
  if (report.claims.networks > 1)
    text += fmt::format(", {} trained networks of each kind", report.claims.networks);
  text += '\n';
  text += Paragraphs(report.DepartureNotes());
  text += '\n';
  if (const std::string note = VariantNote(report); !note.empty())
    text += tables::Wrap(note, "", tables::kTerminalWidth) + '\n';
  text += tables::ResultTable(report.told, paper::PaperClaims());
  const std::string generalisation = tables::GeneralisationTable(report.generalisation);
  if (!generalisation.empty()) text += '\n' + generalisation;
  const std::string look_forward = tables::LookForwardText(report.look_forward);
  if (!look_forward.empty()) text += '\n' + look_forward;
  const std::string differences =
      variants::ArmDifferenceText(report.differences) + Paragraphs(report.difference_notes);
  if (!differences.empty()) text += '\n' + differences;
  const std::string verdicts = claims::VerdictText(report.claims);
  if (!verdicts.empty()) text += '\n' + verdicts;
  const std::string variants = variants::VariantText(report.variants);
  if (variants.empty()) return text;
  return text + '\n' + variants::VariantValuesText(report.arms) + '\n' + variants +
         Paragraphs(report.variant_notes);
}

nlohmann::ordered_json ReportJson(const Report& report) {
  nlohmann::ordered_json json = {{"name", report.name}};
  if (!report.mixed_code.empty()) json["mixed_code"] = report.mixed_code;
  if (report.unchecked) json["unchecked"] = store::kNothingToCompare;
  const auto departures = report.departures.find(report.variant);
  json["paper"] = DeparturesJson(departures == report.departures.end() ? Departures() : departures->second,
                                 report.judging);
  json.update(tables::ResultJson(report.arms, paper::PaperClaims()));
  json["generalisation"] = tables::GeneralisationJson(report.generalisation);
  json["look_forward"] = tables::LookForwardJson(report.look_forward);
  json["differences"] = variants::ArmDifferenceJson(report.differences);
  json["difference_notes"] = report.difference_notes;
  json["claims"] = claims::VerdictJson(report.claims);
  return json;
}

namespace {

struct NamedText {
  std::string name, text;
};

std::vector<NamedText> FilesOf(const Report& report) {
  const std::vector<paper::Claim>& claims = paper::PaperClaims();
  std::vector<NamedText> files = {{"report.txt", ReportText(report)},
                                  {"report.json", ReportJson(report).dump(2) + '\n'},
                                  {"metrics.csv", tables::ResultCsv(report.arms, claims)},
                                  {"generalisation.csv", tables::GeneralisationCsv(report.generalisation)},
                                  {"verdicts.csv", claims::VerdictCsv(report.claims)},
                                  {"convergence.csv", claims::ConvergenceCsv(report.convergence)},
                                  {"look_forward.csv", tables::LookForwardCsv(report.look_forward)}};
  if (report.claims.networks > 1) files.push_back({"by_network.csv", claims::ByNetworkCsv(report.claims)});
  if (!report.differences.empty())
    files.push_back({"differences.csv", variants::ArmDifferenceCsv(report.differences)});
  if (!report.variants.variants.empty()) {
    files.push_back({"variants.csv", variants::DifferenceCsv(report.variants)});
    files.push_back({"variant_verdicts.csv", variants::VariantVerdictCsv(report.variants)});
  }
  for (const tables::StudyTable& table : report.tables) {
    const std::string stem = "tables/" + table.id;
    files.push_back({stem + ".md", tables::MarkdownTable(table, claims)});
    files.push_back({stem + ".tex", tables::LatexTable(table, claims)});
    files.push_back({stem + ".csv", tables::CsvTable(table, claims)});
    files.push_back({stem + ".json", tables::JsonTable(table, claims).dump(2) + '\n'});
  }
  return files;
}

}  // namespace

const std::vector<std::string>& ReportFileNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {"report.txt",      "report.json",         "metrics.csv",
                                    "verdicts.csv",    "generalisation.csv",  "by_network.csv",
                                    "convergence.csv", "look_forward.csv",    "differences.csv",
                                    "variants.csv",    "variant_verdicts.csv"};
    for (const char* table : {"arms", "thresholds", "ablations", "baselines", "variants"})
      for (const char* ending : {".md", ".tex", ".csv", ".json"})
        all.push_back(fmt::format("tables/{}{}", table, ending));
    return all;
  }();
  return names;
}

void WriteReport(const Report& report, const std::string& dir) {
  const fs::path base(dir);
  const std::vector<NamedText> files = FilesOf(report);  // before any is touched
  const std::vector<std::string>& names = ReportFileNames();
  MakeFolder(base / "tables");
  for (const NamedText& file : files) {
    // What is not on the list would stay beside a later report.
    ED3R_CHECK(std::find(names.begin(), names.end(), file.name) != names.end(), file.name);
    WriteFile(base / file.name, file.text);
  }
}

}  // namespace ed3r::report
