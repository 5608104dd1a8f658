#include "studies/claims/verdict_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/files/csv_table.h"
#include "studies/claims/equivalence.h"
#include "studies/metrics/number_text.h"
#include "studies/paper/arms.h"
#include "studies/tables/layout.h"
#include "studies/tables/names.h"
#include "studies/tables/study_table.h"

namespace ed3r::claims {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kP85Ending = "-p85";

constexpr int kIdWidth = 5, kClaimWidth = 44, kPaperWidth = 8, kOursWidth = 25, kPWidth = 8,
              kVerdictWidth = 17;

// "total energy" for "total_energy_kj".
std::string Spoken(std::string metric) {
  for (const std::string_view unit : {"_kj", "_pct", "_min"})
    if (metric.ends_with(unit)) metric.resize(metric.size() - unit.size());
  std::replace(metric.begin(), metric.end(), '_', ' ');
  return metric;
}

std::string Cut(const std::string& text, int width) {
  if (tables::DisplayWidth(text) <= width) return text;
  std::string cut;
  for (const char c : text) {
    const bool starts_character = (c & 0xC0) != 0x80;
    if (starts_character && tables::DisplayWidth(cut) == width - 1) break;
    cut += c;
  }
  return cut + "…";
}

std::string Short(double value, bool sign) {
  if (std::isnan(value)) return "";
  const double size = std::abs(value);
  const int decimals = size >= 1000 ? 0 : size >= 99.95 ? 1 : 2;
  return sign ? fmt::format("{:+.{}f}", value, decimals) : fmt::format("{:.{}f}", value, decimals);
}

std::string OursText(const Judgement& judged, bool sign) {
  if (std::isnan(judged.ours)) return "–";
  if (std::isnan(judged.lo)) return Short(judged.ours, sign);
  return fmt::format("{} [{}, {}]", Short(judged.ours, sign), Short(judged.lo, sign), Short(judged.hi, sign));
}

// The smaller of the two p-values, with '!' where it speaks against the claim.
std::string PText(const JudgedClaim& claim) {
  const Judgement& judged = claim.all;
  if (std::isnan(judged.p_holm)) return "";
  const double p = std::min(judged.p_holm, judged.p_against_holm);
  return (p < 0.0001 ? "<0.0001" : fmt::format("{:.{}f}", p, p < 0.01 ? 4 : 3)) +
         (PointsTheOtherWay(claim) ? "!" : " ");
}

// "2r 3d": verdicts of the networks alone.
std::string NetworksText(const JudgedClaim& claim) {
  if (!claim.asks_networks) return "";
  std::string text;
  for (const auto& [verdict, count] : CountByNetwork(claim))
    text += fmt::format("{}{}{}", text.empty() ? "" : " ", count, LetterOf(verdict));
  return text;
}

std::string Line(const std::string& id, const std::string& claim, const std::string& paper,
                 const std::string& ours, const std::string& p, const std::string& verdict,
                 const std::string& networks) {
  return tables::Pad(id, kIdWidth, tables::Align::kLeft) +
         tables::Pad(claim, kClaimWidth, tables::Align::kLeft) +
         tables::Pad(paper, kPaperWidth, tables::Align::kRight) + "  " +
         tables::Pad(ours, kOursWidth, tables::Align::kLeft) +
         tables::Pad(p, kPWidth, tables::Align::kRight) + "  " +
         tables::Pad(verdict, kVerdictWidth, tables::Align::kLeft) + ' ' + networks + '\n';
}

std::string Table(const ClaimStudy& study) {
  const bool networks = study.networks > 1;
  std::string text =
      Line("", "claim", "paper", "ours [95 % interval]", "p Holm", "verdict", networks ? "alone" : "");
  text += tables::Rule(tables::kTerminalWidth) + '\n';
  for (const JudgedClaim& judged : study.claims) {
    if (judged.all.verdict == Verdict::kNotMeasured) continue;
    const bool order = judged.claim.kind == "order";
    const std::string paper = order ? Short(judged.all.paper, true) : judged.claim.paper_value;
    const std::string about = judged.claim.source == "about" ? "~" : "";
    text += Line(judged.claim.id, ClaimInWords(judged.claim, kClaimWidth - 1), about + paper,
                 OursText(judged.all, order), PText(judged), NameWithLuck(judged), NetworksText(judged));
  }
  return text;
}

std::string Summary(const ClaimStudy& study) {
  std::map<Verdict, int> counts = CountVerdicts(study);
  std::vector<std::string> parts;
  for (const Verdict verdict : kVerdicts)
    if (counts[verdict] > 0) {
      parts.push_back(fmt::format("{} {}", counts[verdict], NameOf(verdict)));
      if (const int built = CountReproducedByConstruction(study);
          verdict == Verdict::kReproduced && built > 0)
        parts.back() += fmt::format(" ({} by construction)", built);
      if (const int fitted = CountCalibrated(study); verdict == Verdict::kEquivalent && fitted > 0)
        parts.back() += fmt::format(" ({} calibrated on)", fitted);
      if (const int luck = CountWithinLuck(study); verdict == Verdict::kDiffers && luck > 0)
        parts.back() += fmt::format(" ({} of them no more than one network may)", luck);
    }
  return tables::Wrap(fmt::format("{} claims, {} of them different: {}.", study.claims.size(),
                                  CountDistinct(study), fmt::join(parts, ", ")),
                      "", tables::kTerminalWidth);
}

std::string Unmeasured(const ClaimStudy& study) {
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const JudgedClaim& judged : study.claims)
    if (judged.all.verdict == Verdict::kNotMeasured) {
      const bool absent = judged.all.why.starts_with(kNotInThisRun);
      by_reason[absent ? "arms that are not in this run, or P85 groups too small for a verdict"
                       : judged.all.why]
          .push_back(judged.claim.id);
    }
  constexpr std::size_t kListed = 40;  // more say nothing that verdicts.csv does not say better
  std::string text;
  for (const auto& [reason, ids] : by_reason)
    text += ids.size() > kListed ? tables::Wrap(fmt::format("{}: {} claims", reason, ids.size()),
                                                "Not measured, ", tables::kTerminalWidth)
                                 : tables::Wrap(fmt::format("{}: {}", reason, fmt::join(ids, " ")),
                                                "Not measured, ", tables::kTerminalWidth);
  return text;
}

// Of the table, in sentences with {} for what a run has.
constexpr const char* kRules =
    "equivalent: ours (the mean over our networks) is the paper's number within {:g} % of a size or {:g} "
    "points of a percentage, "
    "whatever chance may have done to either (95 %, the sampling of the paper's own missions included; the "
    "luck of the one network "
    "that it seems to have trained is not). imprecise: compatible with it, but not known well enough. "
    "differs: the sampling of "
    "missions and our networks does not explain the difference; or the opposite order holds. reproduced: an "
    "order holds and so do the "
    "sizes that the paper prints. direction holds: p < 0.05, another size. not decidable: an order without p "
    "< 0.05 either way.";
constexpr const char* kOrderNote =
    "An order shows the difference in its least certain part, + as claimed, and the paper's in the same "
    "part; "
    "verdicts.csv tells which, and why each verdict. Differences are paired over scenarios; p values are "
    "two-sided; with ! the claim points the other way.";
constexpr const char* kCorrectionNote =
    "Intervals are for each claim alone; p is corrected by Holm for all {} different directional claims, so "
    "that an "
    "interval may leave out 0 beside a p above 0.05: the p decides.";
constexpr const char* kLuckNote =
    "(luck): it differs, but one network, trained and flown as often as the paper's, may differ as much by "
    "luck (95 % "
    "prediction interval from the spread of ours). (luck?): our networks spread too widely to tell.";
constexpr const char* kNetworksNote =
    "Intervals and p values include the luck of training ({} networks, Student's t). alone: verdicts by the "
    "missions "
    "of each network alone, {} (too few of its missions).";
constexpr const char* kTurnsNote =
    "Arms took turns among their networks differently: they are paired by scenario only. Nothing that "
    "compares arms of different "
    "numbers of networks is decided.";
constexpr const char* kOneNetworkNote =
    "Each arm that asks a network flew with one: its intervals and p values are over missions alone and say "
    "nothing "
    "of the luck of training, which may be larger (training.seeds).";

std::string Notes(const ClaimStudy& study) {
  const auto wrapped = [](const std::string& text) { return tables::Wrap(text, "", tables::kTerminalWidth); };
  std::string notes = wrapped(VerdictRules());
  if (study.family > 0) notes += wrapped(kOrderNote) + wrapped(CorrectionNote(study));
  if (const std::string p85 = P85ClaimNote(study); !p85.empty()) notes += wrapped(p85);
  if (std::any_of(study.claims.begin(), study.claims.end(), [](const JudgedClaim& judged) {
        return judged.luck == Luck::kWithin || judged.luck == Luck::kTooWide;
      }))
    notes += wrapped(kLuckNote);
  if (study.networks < 2) return notes + wrapped(kOneNetworkNote);
  notes += wrapped(fmt::format(kNetworksNote, study.networks, kVerdictLetters));
  return study.networks_disagree ? notes + wrapped(kTurnsNote) : notes;
}

Json ByNetworkJson(const JudgedClaim& judged) {
  Json counts = Json::object(), verdicts = Json::array(), ours = Json::array();
  for (const auto& [verdict, count] : CountByNetwork(judged)) counts[std::string(NameOf(verdict))] = count;
  for (const Judgement& alone : judged.by_network)
    verdicts.push_back(NameOf(alone.verdict)), ours.push_back(metrics::JsonNumber(alone.ours));
  return {{"counts", counts}, {"verdicts", verdicts}, {"ours", ours}};
}

}  // namespace

std::string VerdictRules() { return fmt::format(kRules, 100 * kMarginShare, kMarginPoints); }

std::string CorrectionNote(const ClaimStudy& study) {
  return study.family > 0 ? fmt::format(kCorrectionNote, study.family) : "";
}

std::string LuckNote() { return kLuckNote; }

bool ComparesP85(const JudgedClaim& judged) {
  const std::string& text = judged.claim.comparison;
  const std::size_t first = text.find(kP85Ending);
  return first != std::string::npos && text.find(kP85Ending, first + 1) != std::string::npos;
}

std::string P85ClaimNote(const ClaimStudy& study) {
  std::vector<std::pair<std::string, double>> success;
  bool compared = false;
  for (const JudgedClaim& judged : study.claims) {
    if (judged.all.verdict == Verdict::kNotMeasured) continue;
    compared = compared || ComparesP85(judged);
    if (judged.claim.kind == "value" && judged.claim.metric == "msr_pct" && judged.repeats.empty() &&
        paper::IsP85Name(judged.claim.strategy))
      success.emplace_back(tables::ArmLabel(judged.claim.strategy), judged.all.ours);
  }
  return compared && !success.empty() ? tables::P85Note(success) : "";
}

std::pair<int, int> AgreeingNetworks(const JudgedClaim& judged) {
  std::pair<int, int> found;
  if (!judged.asks_networks) return found;
  for (const Judgement& alone : judged.by_network)
    found.first += alone.verdict == judged.all.verdict && alone.verdict != Verdict::kNotMeasured,
        found.second += alone.verdict != Verdict::kNotMeasured;
  return found;
}

bool PointsTheOtherWay(const JudgedClaim& judged) { return judged.all.p_against < judged.all.p; }

std::string ClaimInWords(const paper::Claim& claim, int width) {
  std::string metric = Spoken(claim.metric);
  std::string what = claim.comparison.empty() ? claim.strategy : claim.comparison;
  if (claim.comparison.empty()) return Cut(what + ' ' + metric, width);
  if (claim.metric == "pareto") metric = "energy and MSR";
  const std::string words = metric + ": " + what;
  return tables::DisplayWidth(words) <= width ? words : Cut(metric + ", \"" + claim.exact_words + '"', width);
}

std::string VerdictText(const ClaimStudy& study) {
  if (!study.HasArms()) return "";
  return tables::TrimLineEnds("What the paper claims\n" + Summary(study) + '\n' + Notes(study) + '\n' +
                              Table(study) + '\n' + Unmeasured(study));
}

Json VerdictJson(const ClaimStudy& study) {
  Json all = Json::array();
  if (!study.HasArms()) return all;
  for (const JudgedClaim& judged : study.claims) {
    const paper::Claim& claim = judged.claim;
    all.push_back({{"id", claim.id},
                   {"where", claim.where},
                   {"strategy", claim.strategy},
                   {"metric", claim.metric},
                   {"kind", claim.kind},
                   {"claim", claim.comparison.empty() ? claim.strategy : claim.comparison},
                   {"words", claim.exact_words},
                   {"paper", metrics::JsonNumber(judged.all.paper)},
                   {"ours", metrics::JsonNumber(judged.all.ours)},
                   {"lo", metrics::JsonNumber(judged.all.lo)},
                   {"hi", metrics::JsonNumber(judged.all.hi)},
                   {"margin", metrics::JsonNumber(judged.all.margin)},
                   {"difference_lo", metrics::JsonNumber(judged.all.difference_lo)},
                   {"difference_hi", metrics::JsonNumber(judged.all.difference_hi)},
                   {"p", metrics::JsonNumber(judged.all.p)},
                   {"p_against", metrics::JsonNumber(judged.all.p_against)},
                   {"p_holm", metrics::JsonNumber(judged.all.p_holm)},
                   {"p_against_holm", metrics::JsonNumber(judged.all.p_against_holm)},
                   {"verdict", NameOf(judged.all.verdict)},
                   {"luck", NameOf(judged.luck)},
                   {"repeats", judged.repeats},
                   {"why", judged.all.why},
                   {"by_network", ByNetworkJson(judged)}});
  }
  return all;
}

std::string VerdictCsv(const ClaimStudy& study) {
  std::string csv =
      "id,where,strategy,metric,kind,claim,paper,ours,lo,hi,margin,difference_lo,difference_hi,p,p_against,p_"
      "holm,"
      "p_against_holm,verdict,luck,repeats,why";
  for (const Verdict verdict : kVerdicts) {
    std::string column(NameOf(verdict));
    std::replace(column.begin(), column.end(), ' ', '_');
    csv += ",networks_" + column;
  }
  csv += '\n';
  if (!study.HasArms()) return csv;
  for (const JudgedClaim& judged : study.claims) {
    const paper::Claim& claim = judged.claim;
    const std::string& what = claim.comparison.empty() ? claim.strategy : claim.comparison;
    csv +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", claim.id,
                    CsvField(claim.where), CsvField(claim.strategy), claim.metric, claim.kind, CsvField(what),
                    metrics::CsvNumber(judged.all.paper), metrics::CsvNumber(judged.all.ours),
                    metrics::CsvNumber(judged.all.lo), metrics::CsvNumber(judged.all.hi),
                    metrics::CsvNumber(judged.all.margin), metrics::CsvNumber(judged.all.difference_lo),
                    metrics::CsvNumber(judged.all.difference_hi), metrics::CsvNumber(judged.all.p),
                    metrics::CsvNumber(judged.all.p_against), metrics::CsvNumber(judged.all.p_holm),
                    metrics::CsvNumber(judged.all.p_against_holm), NameOf(judged.all.verdict),
                    NameOf(judged.luck), judged.repeats, CsvField(judged.all.why));
    std::map<Verdict, int> counts = CountByNetwork(judged);
    for (const Verdict verdict : kVerdicts) csv += fmt::format(",{}", counts[verdict]);
    csv += '\n';
  }
  return csv;
}

std::string ByNetworkCsv(const ClaimStudy& study) {
  std::string csv = "claim,network,verdict,ours\n";
  for (const JudgedClaim& judged : study.claims)
    for (std::size_t network = 0; judged.asks_networks && network < judged.by_network.size(); ++network)
      csv += fmt::format("{},{},{},{}\n", judged.claim.id, network + 1,
                         NameOf(judged.by_network[network].verdict),
                         metrics::CsvNumber(judged.by_network[network].ours));
  return csv;
}

}  // namespace ed3r::claims
