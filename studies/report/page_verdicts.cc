#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/claims/verdict_tables.h"
#include "studies/report/page_parts.h"
#include "studies/tables/layout.h"

namespace ed3r::report {
namespace {

// The name of a verdict as a class of the style sheet: "direction holds" -> "direction".
std::string ClassOf(claims::Verdict verdict) {
  const std::string_view name = NameOf(verdict);
  return "v-" + std::string(name.substr(0, name.find(' ')));
}

std::string Number(double value) { return std::isnan(value) ? "" : tables::FormatValue(value, 2); }

// The smaller of the two, with '!' where the claim points the other way.
std::string PValue(const claims::JudgedClaim& judged) {
  if (std::isnan(judged.all.p_holm)) return "";
  const double p = std::min(judged.all.p_holm, judged.all.p_against_holm);
  return (p < 0.001 ? "&lt; 0.001" : fmt::format("{:.3f}", p)) +
         (claims::PointsTheOtherWay(judged) ? "!" : "");
}

// "4 of 5": networks that alone give the verdict of all missions.
std::string Agreement(const claims::JudgedClaim& judged) {
  const auto [same, measured] = claims::AgreeingNetworks(judged);
  return measured == 0 ? "" : fmt::format("{} of {}", same, measured);
}

std::string Row(const claims::JudgedClaim& judged) {
  constexpr int kWords = 60;
  const claims::Judgement& all = judged.all;
  const std::string interval =
      std::isnan(all.lo) ? "" : Number(all.lo) + (all.lo < 0 || all.hi < 0 ? " to " : "–") + Number(all.hi);
  const std::string told = std::string(claims::NameWithLuck(judged)) +
                           (claims::PointsTheOtherWay(judged) ? ", points the other way" : "");
  return fmt::format(
      "<tr><td title=\"{}\">{}</td><td "
      "class=\"text\">{}<small>{}</small></td><td>{}</td><td>{}<i>{}</i></td><td>{}</td>"
      "<td>{}</td><td class=\"text\"><span class=\"{}\">{}</span></td></tr>\n",
      HtmlText(judged.claim.exact_words), HtmlText(judged.claim.id),
      HtmlText(claims::ClaimInWords(judged.claim, kWords)), HtmlText(all.why), Number(all.paper),
      Number(all.ours), interval, PValue(judged), Agreement(judged), ClassOf(all.verdict), told);
}

}  // namespace

std::string VerdictSection(const claims::ClaimStudy& study) {
  if (!study.HasArms()) return "";
  std::string html = "<section id=\"verdicts\"><h2>The paper's claims</h2>\n<p class=\"chips\">";
  for (const auto& [verdict, count] : claims::CountVerdicts(study))
    html += fmt::format("<span class=\"{}\"><b>{}</b> {}</span> ", ClassOf(verdict), count, NameOf(verdict));
  html += fmt::format(
      "</p>\n<p class=\"key\">{} claims, {} of them different; {} of those that are reproduced hold by "
      "construction. {}</p>\n<p class=\"key\">Orders and comparisons are paired by scenario ({} of them) and "
      "resampled over {}; with ! a claim points the other way. {} {}</p>\n<p class=\"key\">Networks: how "
      "many of "
      "them, each with its own missions alone, would have given the verdict; empty where one has too few "
      "missions. {}</p>\n",
      study.claims.size(), claims::CountDistinct(study), claims::CountReproducedByConstruction(study),
      HtmlText(claims::VerdictRules()), study.scenarios,
      study.networks > 1 ? fmt::format("{} trained networks and missions", study.networks) : "missions",
      HtmlText(claims::CorrectionNote(study)), HtmlText(claims::P85ClaimNote(study)),
      HtmlText(claims::LuckNote()));
  html +=
      "<details><summary>Every claim that this run can judge</summary>\n<div class=\"wide\"><table "
      "class=\"claims\">\n"
      "<tr><th>claim</th><th class=\"text\">says</th><th>paper</th><th>ours, 95 "
      "%</th><th>p</th><th>networks</th><th class=\"text\">verdict</th></tr>\n";
  for (const claims::JudgedClaim& judged : study.claims)
    if (judged.all.verdict != claims::Verdict::kNotMeasured) html += Row(judged);
  return html +
         "</table></div></details>\n<p class=\"files\"><a "
         "href=\"verdicts.csv\">verdicts.csv</a></p></section>\n";
}

}  // namespace ed3r::report
