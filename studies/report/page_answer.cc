#include "studies/report/page_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/core/check.h"
#include "studies/tables/names.h"
#include "studies/variants/arm_differences.h"

namespace ed3r::report {
namespace {

using Arms = std::vector<const metrics::ArmMetrics*>;

double Success(const metrics::ArmMetrics& arm) { return arm["msr_pct"].value; }
double Energy(const metrics::ArmMetrics& arm) { return arm["total_energy_kj"].value; }

// With a minus sign as in the page's tables.
std::string Number(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  return text.starts_with('-') ? "−" + text.substr(1) : text;
}

std::string WithInterval(const metrics::MetricValue& value, int decimals, const char* unit) {
  if (std::isnan(value.lo)) return fmt::format("{:.{}f} {}", value.value, decimals, unit);
  return fmt::format("{:.{}f} {} ({:.{}f}–{:.{}f})", value.value, decimals, unit, value.lo, decimals,
                     value.hi, decimals);
}

std::string Tells(const metrics::ArmMetrics& arm) {
  return fmt::format("finds the fire in {} of its missions, for {} each",
                     WithInterval(arm["msr_pct"], 1, "%"), WithInterval(arm["total_energy_kj"], 1, "kJ"));
}

const metrics::ArmMetrics* Named(const Arms& arms, std::string_view name) {
  const auto found = std::find_if(arms.begin(), arms.end(),
                                  [&](const metrics::ArmMetrics* arm) { return arm->name == name; });
  return found == arms.end() ? nullptr : *found;
}

const metrics::ArmMetrics* Extreme(const Arms& arms, double (*value)(const metrics::ArmMetrics&),
                                   double sign) {
  return *std::max_element(arms.begin(), arms.end(),
                           [&](const metrics::ArmMetrics* a, const metrics::ArmMetrics* b) {
                             return sign * value(*a) < sign * value(*b);
                           });
}

// The subject minus another arm in one metric, as far as it is known.
struct Difference {
  double value = 0, lo = 0, hi = 0;
  double p = std::numeric_limits<double>::quiet_NaN();  // after Holm's correction; NaN: not tested
  const char* unit = "";
  bool one_network = false;
  int family = 0;  // of how many p values the correction was
};

constexpr double kLevel = 0.05;

// An interval clear of 0 beside a p that is not below the level: the interval is of this comparison alone, the p is corrected.
std::string Significance(const Difference& d) {
  const std::string p = d.p < 0.001 ? "p < 0.001" : fmt::format("p = {:.3f}", d.p);
  if (d.p < kLevel) return p + ", significant";
  if (d.lo <= 0 && d.hi >= 0) return p + ", not significant";
  return fmt::format("clear of 0 taken alone, but not significant among all {} compared: {}", d.family, p);
}

// "11.4 points more success (4.7 to 18.2; clear of 0 taken alone, but not significant among all 45 compared: p = 0.074)".
std::string Tells(const Difference& d, const char* of) {
  const bool less = d.value < 0;
  std::string text = fmt::format("{:.1f} {} {} {}", std::abs(d.value), d.unit, less ? "less" : "more", of);
  if (std::isnan(d.p)) return text + " (not tested)";
  return text + fmt::format(" ({} to {}; {}{})", Number(less ? -d.hi : d.lo, 1),
                            Number(less ? -d.lo : d.hi, 1), Significance(d),
                            d.one_network ? ", the luck of training not counted: one network" : "");
}

// What a claim of the paper says of the two: for energy the saving in percent.
std::optional<Difference> Claimed(const claims::ClaimStudy& study, const std::string& subject,
                                  const std::string& rival, std::string_view metric) {
  const bool energy = metric == "total_energy_kj";
  const std::string comparison =
      fmt::format(fmt::runtime(energy ? "100*(1 - {} / {})" : "{} - {}"), subject, rival);
  for (const claims::JudgedClaim& judged : study.claims) {
    const claims::Judgement& all = judged.all;
    if (judged.claim.comparison != comparison || judged.claim.metric != metric || std::isnan(all.p_holm))
      continue;
    Difference d{.value = all.ours,
                 .lo = all.lo,
                 .hi = all.hi,
                 .p = std::min(all.p_holm, all.p_against_holm),
                 .unit = energy ? "%" : "points",
                 .one_network = study.networks < 2,
                 .family = study.family};
    if (energy) d.value = -all.ours, d.lo = -all.hi, d.hi = -all.lo;
    return d;
  }
  return std::nullopt;
}

int Tested(const std::vector<variants::ArmDifference>& differences) {
  return static_cast<int>(std::count_if(differences.begin(), differences.end(),
                                        [](const auto& d) { return !std::isnan(d.p_holm); }));
}

// Of these comparisons, whichever way round they have the two arms.
std::optional<Difference> Compared(const std::vector<variants::ArmDifference>& differences,
                                   const metrics::ArmMetrics& subject, const metrics::ArmMetrics& rival,
                                   std::string_view metric) {
  const int family = Tested(differences);
  for (const variants::ArmDifference& d : differences) {
    if (d.metric != metric || d.stage != subject.stage) continue;
    const char* unit = metric == "total_energy_kj" ? "kJ" : "points";
    if (d.arm == subject.name && d.minus == rival.name)
      return Difference{d.difference, d.lo, d.hi, d.p_holm, unit, d.OneNetwork(), family};
    if (d.arm == rival.name && d.minus == subject.name)
      return Difference{-d.difference, -d.hi, -d.lo, d.p_holm, unit, d.OneNetwork(), family};
  }
  return std::nullopt;
}

// "RBS finds ...: in the same scenarios ED³R-75 has 11.4 points more success (...) and 69.2 % less energy (...)."
std::string Against(const Report& report, const std::vector<variants::ArmDifference>& differences,
                    const metrics::ArmMetrics& subject, const metrics::ArmMetrics& rival) {
  const std::string theirs = fmt::format("{} {}", tables::ArmLabel(rival.name), Tells(rival));
  constexpr std::pair<const char*, const char*> kMetrics[] = {{"msr_pct", "success"},
                                                              {"total_energy_kj", "energy"}};
  // One correction for both.
  const bool of_claims = std::all_of(std::begin(kMetrics), std::end(kMetrics), [&](const auto& metric) {
    return Claimed(report.claims, subject.name, rival.name, metric.first).has_value();
  });
  std::vector<std::string> parts;
  for (const auto& [metric, of] : kMetrics)
    if (const std::optional<Difference> d = of_claims
                                                ? Claimed(report.claims, subject.name, rival.name, metric)
                                                : Compared(differences, subject, rival, metric))
      parts.push_back(Tells(*d, of));
  if (parts.empty())
    return theirs + "; the two flew no scenarios in common, so nothing is said of their difference.";
  return fmt::format(
      "{}: in the same scenarios {} has {} (95 % intervals; p after Holm's correction for all {} {}).",
      theirs, tables::ArmLabel(subject.name), fmt::join(parts, " and "),
      of_claims ? report.claims.family : Tested(differences), of_claims ? "claims" : "comparisons of arms");
}

// "A, B and C".
std::string Listed(const std::vector<std::string>& names) {
  if (names.size() == 1) return names.front();
  const std::vector<std::string> most(names.begin(), names.end() - 1);
  return fmt::format("{} and {}", fmt::join(most, ", "), names.back());
}

std::string Preferable(const metrics::ArmMetrics& subject, const Arms& arms) {
  std::vector<std::string> names;
  for (const metrics::ArmMetrics* arm : arms)
    if (arm != &subject && Success(*arm) >= Success(subject) && Energy(*arm) <= Energy(subject))
      names.push_back(tables::ArmLabel(arm->name));
  if (names.empty())
    return fmt::format("No other arm has both more success and less energy on average than {}.",
                       tables::ArmLabel(subject.name));
  return fmt::format("On average {} {} at least as much success for no more energy than {}.", Listed(names),
                     names.size() == 1 ? "has" : "have", tables::ArmLabel(subject.name));
}

// "Ablation 2 has the lowest mean energy (8.1 kJ) and the highest mean success (90.5 %) of all arms; ..."
std::string Best(const metrics::ArmMetrics& subject, const Arms& arms,
                 const std::vector<variants::ArmDifference>& differences) {
  const metrics::ArmMetrics *frugal = Extreme(arms, Energy, -1), *successful = Extreme(arms, Success, 1);
  if (Energy(subject) == Energy(*frugal)) frugal = &subject;
  if (Success(subject) == Success(*successful)) successful = &subject;
  const std::string energy = fmt::format("the lowest mean energy ({:.1f} kJ)", Energy(*frugal)),
                    success = fmt::format("the highest mean success ({:.1f} %)", Success(*successful));
  std::string text =
      frugal == successful
          ? fmt::format("{} has {} and {} of all arms", tables::ArmLabel(frugal->name), energy, success)
          : fmt::format("Of all arms {} has {} and {} {}", tables::ArmLabel(frugal->name), energy,
                        tables::ArmLabel(successful->name), success);
  std::vector<std::string> parts;
  const auto add = [&](const metrics::ArmMetrics& best, const char* metric, const char* of) {
    if (&best == &subject) return;
    if (const std::optional<Difference> d = Compared(differences, best, subject, metric))
      parts.push_back(Tells(*d, of));
  };
  add(*frugal, "total_energy_kj", "energy");
  add(*successful, "msr_pct", "success");
  if (parts.empty()) return text + '.';
  return text + fmt::format(
                    "; beside {} that is {} (p after Holm's correction for all {} comparisons of arms "
                    "with {}).",
                    tables::ArmLabel(subject.name), fmt::join(parts, " and "), Tested(differences),
                    tables::ArmLabel(subject.name));
}

std::string Claims(const claims::ClaimStudy& study) {
  if (!study.HasArms()) return "";
  int judged = 0, hold = 0, differ = 0;
  for (const auto& [verdict, count] : claims::CountVerdicts(study)) {
    if (verdict == claims::Verdict::kNotMeasured) continue;
    judged += count;
    if (claims::Holds(verdict)) hold += count;
    if (verdict == claims::Verdict::kDiffers) differ += count;
  }
  if (judged == 0) return "";
  const int built = claims::CountReproducedByConstruction(study);
  return fmt::format(
      "Of the {} different claims of the paper that this run can judge, {} hold{}, {} differ and {} stay "
      "open.",
      judged, hold, built > 0 ? fmt::format(" ({} of them by construction)", built) : "", differ,
      judged - hold - differ);
}

// The random walk; else what the arms of its stage are compared with; else the weakest. Null where it is alone.
const metrics::ArmMetrics* Rival(const Report& report, const Arms& arms, const metrics::ArmMetrics& subject) {
  const auto other = [&](const metrics::ArmMetrics* arm) { return arm != nullptr && arm != &subject; };
  if (const metrics::ArmMetrics* walk = Named(arms, "rbs"); other(walk)) return walk;
  for (const variants::ArmDifference& d : report.differences)
    if (d.stage == subject.stage && d.arm == subject.name)
      if (const metrics::ArmMetrics* reference = Named(arms, d.minus); other(reference)) return reference;
  for (const metrics::ArmMetrics* weakest : {Extreme(arms, Success, -1), Extreme(arms, Energy, 1)})
    if (other(weakest)) return weakest;
  return nullptr;
}

}  // namespace

const metrics::ArmMetrics* StudiedArm(const Report& report, const std::vector<bool>& warmups) {
  ED3R_CHECK(warmups.size() == report.told.size(), "warm-up or not, of every arm");
  Arms arms;
  for (std::size_t a = 0; a < report.told.size(); ++a)
    if (!warmups[a] && report.told[a].missions > 0) arms.push_back(&report.told[a]);
  if (arms.empty()) return nullptr;
  const metrics::ArmMetrics* studied = Named(arms, "ed3r-75");
  return studied != nullptr ? studied : Extreme(arms, Success, 1);
}

std::vector<std::string> AnswerSentences(const Report& report, const std::vector<bool>& warmups,
                                         std::span<const metrics::ArmData> missions) {
  ED3R_CHECK(warmups.size() == report.told.size(), "warm-up or not, of every arm");
  ED3R_CHECK(missions.size() == report.told.size(), "missions of every arm");
  const metrics::ArmMetrics* subject = StudiedArm(report, warmups);
  if (subject == nullptr) return {};
  Arms arms;
  std::vector<metrics::ArmData> flown;
  for (std::size_t a = 0; a < report.told.size(); ++a)
    if (!warmups[a] && report.told[a].missions > 0 && report.told[a].stage == subject->stage)
      arms.push_back(&report.told[a]), flown.push_back(missions[a]);
  std::vector<std::string> sentences;
  if (const std::string note = VariantNote(report); !note.empty()) sentences.push_back(note);
  sentences.push_back(tables::ArmLabel(subject->name) + ' ' + Tells(*subject) + '.');
  const metrics::ArmMetrics* rival = Rival(report, arms, *subject);
  if (rival == nullptr) return sentences;
  const std::vector<variants::ArmDifference> beside = variants::CompareArms(flown, subject->name);
  sentences.push_back(
      Against(report, report.differences.empty() ? beside : report.differences, *subject, *rival));
  if (arms.size() > 2) {
    sentences.push_back(Best(*subject, arms, beside));
    sentences.push_back(Preferable(*subject, arms));
  }
  if (const std::string claims = Claims(report.claims); !claims.empty()) sentences.push_back(claims);
  return sentences;
}

}  // namespace ed3r::report
