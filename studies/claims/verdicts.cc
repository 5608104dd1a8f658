#include "studies/claims/verdicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "studies/claims/construction.h"
#include "studies/claims/equivalence.h"
#include "studies/claims/evidence.h"
#include "studies/claims/luck.h"
#include "studies/claims/setup.h"
#include "studies/paper/arms.h"
#include "studies/statistics/holm.h"

namespace ed3r::claims {
namespace {

constexpr double kLevel = 0.05;

struct ParsedClaim {
  const paper::Claim* claim;
  std::optional<Expression> expression;  // none for set-up facts and what no run can show
  std::vector<Cell> cells;
};

ParsedClaim Parse(const paper::Claim& claim) {
  if (claim.kind == "setup" || !claim.unmeasured.empty()) return {&claim, std::nullopt, {}};
  const std::string_view text = claim.comparison.empty() ? claim.strategy : claim.comparison;
  ParsedClaim parsed{&claim, ParseExpression(text, claim.metric), {}};
  parsed.cells = CellsOf(*parsed.expression);
  return parsed;
}

std::string Deviation(const Judgement& judged) {
  const double difference = judged.ours - judged.paper;
  const std::string relative =
      judged.paper == 0 ? "" : fmt::format(" ({:+.0f} %)", 100 * difference / std::abs(judged.paper));
  return fmt::format("ours - paper = {:+.3g}{}", difference, relative);
}

// None where our missions are too few for an interval.
std::optional<SizeVerdict> SizeOf(const paper::Claim& claim, bool exact, Judgement& judged) {
  const paper::PaperValue paper = *paper::PaperValueOf(claim);
  const double lo = exact ? judged.ours : judged.lo, hi = exact ? judged.ours : judged.hi;
  const SizeDifference size = CompareSizes(judged.ours, lo, hi, paper.value, judged.paper_sd, paper.half_unit,
                                           MarginOf(claim, paper.value));
  judged.difference_lo = size.lo, judged.difference_hi = size.hi, judged.margin = size.margin;
  judged.why = Deviation(judged);
  if (std::isnan(size.lo) || std::isnan(size.hi)) {
    judged.verdict = Verdict::kNotMeasured;
    judged.why += "; too few missions for an interval";
    return std::nullopt;
  }
  if (size.verdict == SizeVerdict::kEquivalent && (size.lo > 0 || size.hi < 0))
    judged.why += "; surely not the same, and within the margin";
  return size.verdict;
}

void DecideOrder(const Evidence& evidence, bool similarity, Judgement& judged) {
  judged.why = evidence.detail + (similarity ? "" : " is its least certain part");
  if (judged.p_holm < kLevel) {
    judged.verdict = similarity || evidence.sizes_agree ? Verdict::kReproduced : Verdict::kDirectionHolds;
  } else if (judged.p_against_holm < kLevel) {
    judged.verdict = Verdict::kDiffers;
    judged.why += "; the opposite is significant";
  } else {
    judged.verdict = Verdict::kNotDecidable;
  }
}

void DecideComparison(const paper::Claim& claim, Judgement& judged) {
  const auto size = SizeOf(claim, false, judged);
  if (!size) return;
  if (judged.p_against_holm < kLevel) {
    judged.verdict = Verdict::kDiffers;
    judged.why += "; the opposite is significant";
  } else if (*size == SizeVerdict::kEquivalent) {
    judged.verdict = Verdict::kEquivalent;
  } else if (judged.p_holm < kLevel) {
    judged.verdict = Verdict::kDirectionHolds;
  } else {
    judged.verdict = *size == SizeVerdict::kImprecise ? Verdict::kImprecise : Verdict::kDiffers;
  }
}

void DecideNumber(const paper::Claim& claim, bool exact, Judgement& judged) {
  if (!paper::PaperValueOf(claim)) {  // "n/a"
    judged.verdict = std::isnan(judged.ours) ? Verdict::kReproduced : Verdict::kDiffers;
    judged.why = "the paper has none";
    return;
  }
  if (std::isnan(judged.ours)) {
    judged.verdict = Verdict::kNotMeasured;
    judged.why = "no mission of this run has a value";
    return;
  }
  const auto size = SizeOf(claim, exact, judged);
  if (!size) return;
  switch (*size) {
    case SizeVerdict::kEquivalent:
      judged.verdict = claim.source == "construction" ? Verdict::kReproduced : Verdict::kEquivalent;
      break;
    case SizeVerdict::kImprecise:
      judged.verdict = Verdict::kImprecise;
      break;
    case SizeVerdict::kDiffers:
      judged.verdict = Verdict::kDiffers;
      break;
  }
}

// The longest mission of many is longer than that of few: it compares with the paper's only at the paper's number.
bool GrowsWithTheRun(const ParsedClaim& parsed, std::span<const metrics::ArmData> arms) {
  return std::any_of(parsed.cells.begin(), parsed.cells.end(), [&](const Cell& cell) {
    if (metrics::MetricDefinitions()[cell.metric].estimate != metrics::Estimate::kMaximum) return false;
    const auto arm = std::find_if(arms.rbegin(), arms.rend(), [&](const metrics::ArmData& data) {
      return data.name == cell.arm && !data.missions.empty();
    });
    return arm != arms.rend() && static_cast<double>(arm->missions.size()) != kPaperMissions;
  });
}

bool AsksNetworks(const ParsedClaim& parsed, const ResampledArms& arms) {
  return arms.Missing(parsed.cells).empty() &&
         std::any_of(parsed.cells.begin(), parsed.cells.end(),
                     [&](const Cell& cell) { return arms.At(cell).network_count > 1; });
}

// Claims that say the same of the same have the same key; facts of the set-up are each their own.
std::string KeyOf(const ParsedClaim& parsed) {
  const paper::Claim& claim = *parsed.claim;
  if (!parsed.expression) return claim.id;
  return fmt::format("{}|{}|{}|{}", claim.kind, CanonicalText(*parsed.expression), claim.paper_value,
                     claim.tolerance);
}

void MarkRepeats(const std::vector<ParsedClaim>& parsed, ClaimStudy& study) {
  std::map<std::string, std::string> first;
  for (std::size_t i = 0; i < parsed.size(); ++i) {
    const auto [found, fresh] = first.try_emplace(KeyOf(parsed[i]), parsed[i].claim->id);
    if (!fresh) study.claims[i].repeats = found->second;
  }
}

// One round: every claim by the missions of one set of arms.
class Round {
 public:
  Round(const std::vector<ParsedClaim>& parsed, const std::vector<paper::Claim>& claims,
        std::span<const metrics::ArmData> arms, const ResampledArms& resampled)
      : parsed_(parsed), claims_(claims), data_(arms), arms_(resampled) {}

  int Family() const { return family_; }

  std::vector<Judgement> Judge() {
    Weigh();
    Correct();
    for (std::size_t i = 0; i < parsed_.size(); ++i)
      if (evidence_[i]) Decide(i);
    return judged_;
  }

 private:
  void Weigh() {
    evidence_.resize(parsed_.size());
    judged_.resize(parsed_.size());
    for (std::size_t i = 0; i < parsed_.size(); ++i) {
      const paper::Claim& claim = *parsed_[i].claim;
      const std::vector<std::string> missing = arms_.Missing(parsed_[i].cells);
      if (!claim.unmeasured.empty()) {
        judged_[i].why = claim.unmeasured;
      } else if (claim.kind == "setup") {
        judged_[i] = JudgeSetup(claim, data_);
      } else if (!missing.empty()) {
        judged_[i].why = fmt::format("{}{}", kNotInThisRun, fmt::join(missing, ", "));
      } else if (GrowsWithTheRun(parsed_[i], data_)) {
        judged_[i].why = "the longest of another number of missions than in the paper";
      } else {
        const Expression& expression = *parsed_[i].expression;
        evidence_[i] = expression.is_quantity ? WeighNumber(claim, expression.quantity, arms_)
                                              : WeighOrder(claim, expression.formula, arms_, claims_);
      }
    }
  }

  // The family: every different directional claim once; the paper repeats some.
  void Correct() {
    std::map<std::string, std::size_t> family;
    std::vector<double> p_for, p_against;
    std::vector<std::size_t> member(parsed_.size());
    for (std::size_t i = 0; i < parsed_.size(); ++i) {
      if (!evidence_[i] || !evidence_[i]->directional) continue;
      const auto [found, fresh] = family.try_emplace(
          fmt::format("{}|{}", CanonicalText(*parsed_[i].expression), parsed_[i].claim->tolerance),
          p_for.size());
      member[i] = found->second;
      if (fresh) p_for.push_back(evidence_[i]->p_for), p_against.push_back(evidence_[i]->p_against);
    }
    const std::vector<double> holm_for = statistics::HolmAdjust(p_for),
                              holm_against = statistics::HolmAdjust(p_against);
    for (std::size_t i = 0; i < parsed_.size(); ++i) {
      if (!evidence_[i] || !evidence_[i]->directional) continue;
      judged_[i].p_holm = holm_for[member[i]];
      judged_[i].p_against_holm = holm_against[member[i]];
    }
    family_ = static_cast<int>(p_for.size());
  }

  void Decide(std::size_t i) {
    const Evidence& evidence = *evidence_[i];
    const paper::Claim& claim = *parsed_[i].claim;
    Judgement& judged = judged_[i];
    judged.ours = evidence.ours, judged.lo = evidence.lo, judged.hi = evidence.hi;
    judged.paper = evidence.paper;
    judged.p = evidence.p_for, judged.p_against = evidence.p_against;
    judged.own_sd = evidence.own_sd, judged.paper_sd = evidence.paper_sd;
    judged.missions = evidence.missions;
    if (claim.kind == "order")
      DecideOrder(evidence, claim.tolerance > 0, judged);
    else if (claim.kind == "ratio")
      DecideComparison(claim, judged);
    else
      DecideNumber(claim, evidence.exact, judged);
    if (claim.inconsistent.empty() || judged.verdict == Verdict::kNotMeasured) return;
    judged.verdict = Verdict::kPaperInconsistent;
    judged.why = claim.inconsistent;
  }

  const std::vector<ParsedClaim>& parsed_;
  const std::vector<paper::Claim>& claims_;
  std::span<const metrics::ArmData> data_;
  const ResampledArms& arms_;
  int family_ = 0;
  std::vector<std::optional<Evidence>> evidence_;
  std::vector<Judgement> judged_;
};

}  // namespace

std::string_view NameOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kReproduced:
      return "reproduced";
    case Verdict::kEquivalent:
      return "equivalent";
    case Verdict::kImprecise:
      return "imprecise";
    case Verdict::kDirectionHolds:
      return "direction holds";
    case Verdict::kDiffers:
      return "differs";
    case Verdict::kNotDecidable:
      return "not decidable";
    case Verdict::kPaperInconsistent:
      return "paper inconsistent";
    case Verdict::kNotMeasured:
      return "not measured";
  }
  return "";
}

std::string_view NameOf(Luck luck) {
  constexpr std::string_view kNames[] = {"no", "within", "too wide to tell", "unknown"};
  return kNames[static_cast<std::size_t>(luck)];
}

bool Holds(Verdict verdict) {
  return verdict == Verdict::kReproduced || verdict == Verdict::kEquivalent ||
         verdict == Verdict::kDirectionHolds;
}

std::string NameWithLuck(const JudgedClaim& judged) {
  const char* luck = judged.luck == Luck::kWithin    ? " (luck)"
                     : judged.luck == Luck::kTooWide ? " (luck?)"
                                                     : "";
  return std::string(NameOf(judged.all.verdict)) + luck;
}

char LetterOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kReproduced:
      return 'r';
    case Verdict::kEquivalent:
      return 'e';
    case Verdict::kImprecise:
      return 'c';
    case Verdict::kDirectionHolds:
      return 'h';
    case Verdict::kDiffers:
      return 'd';
    case Verdict::kNotDecidable:
      return 'u';
    case Verdict::kPaperInconsistent:
      return 'i';
    case Verdict::kNotMeasured:
      return 'n';
  }
  return '?';
}

ClaimStudy JudgeClaims(const std::vector<paper::Claim>& claims, std::span<const metrics::ArmData> arms) {
  std::vector<ParsedClaim> parsed;
  std::vector<Cell> cells;
  for (const paper::Claim& claim : claims) {
    parsed.push_back(Parse(claim));
    cells.insert(cells.end(), parsed.back().cells.begin(), parsed.back().cells.end());
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());

  ClaimStudy study;
  const ResampledArms all(arms, cells);
  study.networks = all.networks();
  study.networks_disagree = all.networks_disagree();
  study.scenarios = static_cast<std::int64_t>(all.scenarios());
  Round round(parsed, claims, arms, all);
  const std::vector<Judgement> judged = round.Judge();
  study.family = round.Family();
  for (std::size_t i = 0; i < claims.size(); ++i) {
    JudgedClaim& claim = study.claims.emplace_back();
    claim.claim = claims[i], claim.all = judged[i];
  }
  for (int network = 0; study.networks > 1 && network < study.networks; ++network) {
    const std::vector<metrics::ArmData> part = all.FlownBy(network);
    const std::vector<Judgement> alone = Round(parsed, claims, part, ResampledArms(part, cells)).Judge();
    for (std::size_t i = 0; i < claims.size(); ++i)
      if (claims[i].kind != "setup") study.claims[i].by_network.push_back(alone[i]);
  }
  for (std::size_t i = 0; i < claims.size(); ++i) {
    study.claims[i].asks_networks = AsksNetworks(parsed[i], all);
    study.claims[i].luck = LuckOf(study.claims[i]);
  }
  MarkRepeats(parsed, study);
  return study;
}

std::map<Verdict, int> CountVerdicts(const ClaimStudy& study) {
  std::map<Verdict, int> counts;
  for (const JudgedClaim& judged : study.claims)
    if (judged.repeats.empty()) ++counts[judged.all.verdict];
  return counts;
}

namespace {

template <class Predicate>
int CountDistinctIf(const ClaimStudy& study, const Predicate& predicate) {
  return static_cast<int>(
      std::count_if(study.claims.begin(), study.claims.end(),
                    [&](const JudgedClaim& judged) { return judged.repeats.empty() && predicate(judged); }));
}

}  // namespace

int CountDistinct(const ClaimStudy& study) {
  return CountDistinctIf(study, [](const JudgedClaim&) { return true; });
}

bool HoldsByConstruction(const JudgedClaim& judged) {
  const paper::Claim& claim = judged.claim;
  const bool built = claim.kind == "setup" || claim.source == "construction" ||
                     (claim.kind == "value" && !paper::PaperValueOf(claim));
  return built && judged.all.verdict == Verdict::kReproduced;
}

int CountReproducedByConstruction(const ClaimStudy& study) {
  return CountDistinctIf(study, HoldsByConstruction);
}

int CountCalibrated(const ClaimStudy& study) {
  return CountDistinctIf(study, [](const JudgedClaim& judged) {
    return paper::ArmOfP85Name(judged.claim.strategy) == "rbs" && judged.claim.kind == "value" &&
           judged.all.verdict == Verdict::kEquivalent;
  });
}

int CountWithinLuck(const ClaimStudy& study) {
  return CountDistinctIf(study, [](const JudgedClaim& judged) { return judged.luck == Luck::kWithin; });
}

std::map<Verdict, int> CountByNetwork(const JudgedClaim& claim) {
  std::map<Verdict, int> counts;
  for (const Judgement& judged : claim.by_network) ++counts[judged.verdict];
  return counts;
}

}  // namespace ed3r::claims
