#include "studies/report/page_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"
#include "studies/tables/names.h"

namespace ed3r::report {
namespace {

using Arms = std::vector<const metrics::ArmMetrics*>;

double Success(const metrics::ArmMetrics& arm) { return arm["msr_pct"].value; }
double Energy(const metrics::ArmMetrics& arm) { return arm["total_energy_kj"].value; }

bool Overlap(const metrics::MetricValue& a, const metrics::MetricValue& b) {
  return !(a.lo > b.hi || b.lo > a.hi);
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

std::string Than(double ours, double theirs, const char* more, const char* less) {
  return ours >= theirs ? more : less;
}

// "RBS finds ...: ED³R-75 has 15.4 points more success for 68 % less energy."
std::string Against(const metrics::ArmMetrics& subject, const metrics::ArmMetrics& rival) {
  std::string text = fmt::format("{} {}: {} has {:.1f} points {} success for {:.0f} % {} energy",
                                 tables::ArmLabel(rival.name), Tells(rival), tables::ArmLabel(subject.name),
                                 std::abs(Success(subject) - Success(rival)),
                                 Than(Success(subject), Success(rival), "more", "less"),
                                 std::abs(100 * (Energy(subject) / Energy(rival) - 1)),
                                 Than(Energy(subject), Energy(rival), "more", "less"));
  const bool success_open = Overlap(subject["msr_pct"], rival["msr_pct"]);
  const bool energy_open = Overlap(subject["total_energy_kj"], rival["total_energy_kj"]);
  if (!success_open && !energy_open) return text + ", and neither pair of 95 % intervals overlaps.";
  if (success_open && energy_open) return text + ", but both pairs of 95 % intervals overlap.";
  return text + fmt::format(", but the 95 % intervals of {} overlap.", success_open ? "success" : "energy");
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
  return fmt::format(
      "Of the {} different claims of the paper that this run can judge, {} hold, {} differ and {} stay open.",
      judged, hold, differ, judged - hold - differ);
}

}  // namespace

std::vector<std::string> AnswerSentences(const Report& report, const std::vector<bool>& warmups) {
  ED3R_CHECK(warmups.size() == report.told.size(), "warm-up or not, of every arm");
  Arms arms;
  for (std::size_t a = 0; a < report.told.size(); ++a)
    if (!warmups[a] && report.told[a].missions > 0) arms.push_back(&report.told[a]);
  if (arms.empty()) return {};
  const metrics::ArmMetrics* subject = Named(arms, "ed3r-75");
  if (subject == nullptr) subject = Extreme(arms, Success, 1);
  std::vector<std::string> sentences = {tables::ArmLabel(subject->name) + ' ' + Tells(*subject) + '.'};
  const metrics::ArmMetrics* rival = Named(arms, "rbs");
  if (rival == nullptr || rival == subject) rival = Extreme(arms, Success, -1);
  if (rival == subject) rival = Extreme(arms, Energy, 1);
  if (rival != subject) sentences.push_back(Against(*subject, *rival));
  if (arms.size() > 2) sentences.push_back(Preferable(*subject, arms));
  if (const std::string claims = Claims(report.claims); !claims.empty()) sentences.push_back(claims);
  return sentences;
}

}  // namespace ed3r::report
