#include <fmt/format.h>

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

std::string PValue(double p) {
  if (std::isnan(p)) return "";
  return p < 0.001 ? "&lt; 0.001" : fmt::format("{:.3f}", p);
}

// "4 of 5" networks alone give the verdict of all missions.
std::string Agreement(const claims::JudgedClaim& judged) {
  if (judged.by_network.empty()) return "";
  int same = 0;
  for (const claims::Judgement& alone : judged.by_network) same += alone.verdict == judged.all.verdict;
  return fmt::format("{} of {}", same, judged.by_network.size());
}

std::string Row(const claims::JudgedClaim& judged) {
  constexpr int kWords = 60;
  const claims::Judgement& all = judged.all;
  const std::string interval = std::isnan(all.lo) ? "" : Number(all.lo) + "–" + Number(all.hi);
  return fmt::format(
      "<tr><td title=\"{}\">{}</td><td "
      "class=\"text\">{}<small>{}</small></td><td>{}</td><td>{}<i>{}</i></td><td>{}</td>"
      "<td>{}</td><td class=\"text\"><span class=\"{}\">{}</span></td></tr>\n",
      HtmlText(judged.claim.exact_words), HtmlText(judged.claim.id),
      HtmlText(claims::ClaimInWords(judged.claim, kWords)), HtmlText(all.why), Number(all.paper),
      Number(all.ours), interval, PValue(all.p_holm), Agreement(judged), ClassOf(all.verdict),
      claims::NameWithLuck(judged));
}

}  // namespace

std::string VerdictSection(const claims::ClaimStudy& study) {
  if (!study.HasArms()) return "";
  std::string html = "<section id=\"verdicts\"><h2>The paper's claims</h2>\n<p class=\"chips\">";
  for (const auto& [verdict, count] : claims::CountVerdicts(study))
    html += fmt::format("<span class=\"{}\"><b>{}</b> {}</span> ", ClassOf(verdict), count, NameOf(verdict));
  html += fmt::format(
      "</p>\n<p class=\"key\">Orders and comparisons are paired by scenario ({} of them) and resampled over "
      "{}; p is corrected "
      "by Holm over all of them. The column before the verdict: how many of the networks alone would have "
      "given it. (luck): it differs, but no more than one network on the "
      "paper's number of missions may; (luck?): networks spread too widely to tell.</p>\n",
      study.scenarios,
      study.networks > 1 ? fmt::format("{} trained networks and missions", study.networks) : "missions");
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
