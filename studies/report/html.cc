#include "studies/report/html.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/store/checksums.h"
#include "studies/paper/claims.h"
#include "studies/report/page_parts.h"
#include "studies/report/page_style.h"
#include "studies/tables/layout.h"
#include "studies/tables/paper_cell.h"
#include "studies/variants/difference_text.h"

namespace ed3r::report {
namespace {

constexpr int kDifferenceDecimals = 2;

// One fact of the list at the top.
std::string Fact(std::string_view name, const std::string& value) {
  return value.empty() ? "" : fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, value);
}

std::string Code(const std::string& text) {
  return text.empty() ? "" : "<code>" + HtmlText(text) + "</code>";
}

std::string MachineText(const Provenance::Session& session) {
  const auto note = [&](const char* key) {
    const auto found = session.notes.find(key);
    return found == session.notes.end() ? std::string("unknown") : HtmlText(found->second);
  };
  return fmt::format("{}, {} cores, {} memory, SIMD {}; {}, {}", note("cpu"), note("cores"), note("memory"),
                     note("simd"), note("compiler"), note("flags"));
}

std::string WhatWasRun(const Provenance& p) {
  std::string worlds;
  for (const auto& [file, fingerprint] : p.inputs)
    worlds += fmt::format("{}{} <small>{}</small>", worlds.empty() ? "" : "<br>", HtmlText(file),
                          HtmlText(fingerprint));
  std::string missions = fmt::format("{} of {} planned", p.stored, p.planned);
  if (p.failed > 0) missions += fmt::format(", {} failed in the program", p.failed);
  if (p.stored + p.failed < p.planned)
    missions += fmt::format("; <b>{} still missing</b>", p.planned - p.stored - p.failed);
  std::string machine;
  if (!p.sessions.empty()) machine = MachineText(p.sessions.back());
  if (p.sessions.size() > 1) machine += fmt::format(" (last of {} sessions)", p.sessions.size());
  const std::string when =
      p.sessions.empty() ? ""
                         : p.sessions.front().begun_utc + " to " +
                               (p.sessions.back().ended_utc.empty() ? "now" : p.sessions.back().ended_utc);
  return "<section id=\"run\"><h2>What was run</h2>\n<dl>\n" + Fact("command", Code(p.command)) +
         Fact("sweep", HtmlText(p.sweep)) + Fact("seed", HtmlText(p.seed)) + Fact("missions", missions) +
         Fact("flown time",
              fmt::format("{:.1f} simulated hours in {:.2f} core hours", p.simulated_h, p.wall_h)) +
         Fact("worlds", worlds) +
         Fact("code", fmt::format("commit {}, sources {}{}",
                                  HtmlText(p.commit.empty() ? "unknown" : p.commit), Code(p.code_version),
                                  p.mixed_code ? "; <b>mixed: several versions flew this run</b>" : "")) +
         Fact("time by phase", HtmlText(p.time_by_phase)) + Fact("machine", machine) +
         Fact("when", HtmlText(when)) +
         Fact("digest of the results",
              Code(p.digest) + (p.unchecked ? fmt::format("; <b>{}</b>", store::kNothingToCompare) : "")) +
         "</dl></section>\n";
}

std::string TableCell(const metrics::ArmMetrics& arm, std::size_t metric) {
  const metrics::MetricValue& ours = arm.values[metric];
  const int decimals = metrics::MetricDefinitions()[metric].decimals;
  std::string cell = "<td><b>" + tables::FormatValue(ours.value, decimals) + "</b>";
  if (!std::isnan(ours.lo))
    cell += "<i>" + tables::FormatValue(ours.lo, decimals) + (ours.lo < 0 || ours.hi < 0 ? " to " : "–") +
            tables::FormatValue(ours.hi, decimals) + "</i>";
  if (const tables::PaperCell paper = tables::MakePaperCell(paper::PaperClaims(), arm, metric); paper.value)
    cell += fmt::format("<u{}>{}{}</u>", paper.within ? " class=\"in\"" : "",
                        paper.value->approximate ? "~" : "", HtmlText(paper.value->printed));
  return cell + "</td>";
}

std::string TableHtml(const tables::StudyTable& table) {
  std::string html = fmt::format("<h3 id=\"table-{}\">{}</h3>\n<div class=\"wide\"><table>\n<tr><th></th>",
                                 HtmlText(table.id), HtmlText(table.title));
  const std::size_t rows = table.arms_down ? table.arms.size() : table.metrics.size();
  const std::size_t columns = table.arms_down ? table.metrics.size() : table.arms.size();
  for (std::size_t c = 0; c < columns; ++c)
    html += "<th>" + HtmlText(table.arms_down ? tables::MetricHeading(table.metrics[c]) : table.labels[c]) +
            "</th>";
  html += "</tr>\n";
  for (std::size_t r = 0; r < rows; ++r) {
    html +=
        "<tr><th>" + HtmlText(table.arms_down ? table.labels[r] : tables::MetricHeading(table.metrics[r]));
    if (table.arms_down) html += fmt::format(" <small>{}</small>", table.arms[r].missions);
    html += "</th>";
    for (std::size_t c = 0; c < columns; ++c)
      html += TableCell(table.arms[table.arms_down ? r : c], table.metrics[table.arms_down ? c : r]);
    html += "</tr>\n";
  }
  html += "</table></div>\n";
  if (!table.note.empty()) html += "<p class=\"key\">" + HtmlText(table.note) + "</p>\n";
  html += "<p class=\"files\">";
  for (const char* ending : {"md", "tex", "csv", "json"})
    html += fmt::format("<a href=\"tables/{0}.{1}\">{0}.{1}</a> ", HtmlText(table.id), ending);
  return html + "</p>\n";
}

std::string TableKey() {
  return "<p class=\"key\"><b>bold</b> ours, <i>95 % interval</i>, <u>the paper's value</u>; <u "
         "class=\"in\">green</u> where "
         "it lies in our interval, give or take its rounding. Small numbers beside an arm: missions.</p>\n";
}

// Each arm of a stage minus one of them; "" where the verdicts compare all.
std::string DifferencesHtml(const std::vector<variants::ArmDifference>& differences) {
  if (differences.empty()) return "";
  std::string html =
      "<h3 id=\"differences\">Arms compared</h3>\n<div "
      "class=\"wide\"><table>\n<tr><th></th><th>minus</th><th>metric</th>"
      "<th>difference</th><th>p</th><th>pairs</th></tr>\n";
  for (const variants::ArmDifference& d : differences) {
    const std::size_t metric = metrics::MetricIndex(d.metric);
    const char* mark = d.Certain() ? "b" : "span";
    html += fmt::format(
        "<tr><th>{}</th><td>{}</td><td>{}</td><td><{}>{}</{}><i>{} to "
        "{}</i></td><td>{}</td><td>{}</td></tr>\n",
        HtmlText(d.arm), HtmlText(d.minus), HtmlText(tables::MetricHeading(metric)), mark,
        tables::FormatValue(d.difference, kDifferenceDecimals), mark,
        tables::FormatValue(d.lo, kDifferenceDecimals), tables::FormatValue(d.hi, kDifferenceDecimals),
        HtmlText(variants::PText(d.p_holm)), d.pairs);
  }
  return html +
         "</table></div>\n<p class=\"key\">Paired by scenario, <i>95 % interval</i>; p after Holm's "
         "correction for all of "
         "them, <b>bold</b> below 0.05 unless a single trained network flew on a side. <a "
         "href=\"differences.csv\">differences.csv</a></p>\n";
}

std::string FiguresHtml(const PageInputs& inputs) {
  std::string html = "<section id=\"figures\"><h2>Figures</h2>\n";
  if (!inputs.figures_note.empty()) html += "<p class=\"note\">" + HtmlText(inputs.figures_note) + "</p>\n";
  int number = 0;
  for (const auto& figure : inputs.figures) {
    const std::string id = figure.at("id"), title = figure.at("title"), caption = figure.at("caption");
    html += fmt::format(
        "<figure id=\"figure-{0}\"><a href=\"figures/{0}.svg\"><img src=\"figures/{0}.png\" alt=\"{1}\" "
        "loading=\"lazy\"></a>\n<figcaption><b>Figure {2}. {1}.</b> {3}</figcaption></figure>\n",
        HtmlText(id), HtmlText(title), ++number, HtmlText(caption));
  }
  return html + fmt::format(
                    "<p class=\"files\">All figures: {}; their data, for tools of your own: <a "
                    "href=\"figures/data.json\">figures/data.json</a>; redrawn with <code>scripts/plot.py "
                    "FOLDER</code>, FOLDER holding data.json.</p></section>\n",
                    Code(inputs.report_command));
}

}  // namespace

std::string HtmlText(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string ReportContent(const PageInputs& inputs) {
  const Report& report = inputs.report;
  std::string html = fmt::format(
      "<style>{1}</style>\n<header><h1>{0}</h1><nav><a href=\"#run\">What was run</a> <a "
      "href=\"#headline\">Results</a> "
      "{2}<a "
      "href=\"#tables\">Tables</a> <a href=\"#figures\">Figures</a></nav></header>\n",
      HtmlText(report.name), kPageStyle, report.claims.HasArms() ? "<a href=\"#verdicts\">Claims</a> " : "");
  for (const std::string& note : report.DepartureNotes())
    html += "<p class=\"note\">" + HtmlText(note) + "</p>\n";
  html += WhatWasRun(inputs.provenance);
  html += "<section id=\"headline\"><h2>Results</h2>\n";
  if (report.tables.empty())
    html += "<p class=\"note\">No missions yet.</p>\n";
  else
    html += TableHtml(report.tables.front()) + TableKey() + DifferencesHtml(report.differences);
  html += "</section>\n" + VerdictSection(report.claims);
  html += "<section id=\"tables\"><h2>Tables</h2>\n";
  for (std::size_t t = 1; t < report.tables.size(); ++t) html += TableHtml(report.tables[t]);
  html += fmt::format(
      "<p class=\"files\">Every metric of every arm: <a href=\"report.txt\">report.txt</a> <a "
      "href=\"report.json\">report.json</a> <a href=\"metrics.csv\">metrics.csv</a> <a "
      "href=\"generalisation.csv\">generalisation.csv</a>, made by {}</p></section>\n",
      Code(inputs.report_command));
  return html + FiguresHtml(inputs);
}

std::string ReportPage(const PageInputs& inputs) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>{} – ED³R "
      "report</title></head>\n<body>\n{}</body></html>\n",
      HtmlText(inputs.report.name), ReportContent(inputs));
}

}  // namespace ed3r::report
