// StudyTable as Markdown, LaTeX, CSV and JSON.
#include <fmt/format.h>

#include <cmath>

#include "engine/core/files/csv_table.h"
#include "studies/metrics/number_text.h"
#include "studies/tables/layout.h"
#include "studies/tables/paper_cell.h"
#include "studies/tables/study_table.h"

namespace ed3r::tables {
namespace {

struct Cell {
  std::string value, interval, paper;  // "21.93", "19.85–23.95", "21.44"; empty where there is none
};

Cell MakeCell(const StudyTable& table, const std::vector<paper::Claim>& claims, std::size_t arm,
              std::size_t metric) {
  const metrics::MetricValue& ours = table.arms[arm].values[metric];
  const int decimals = metrics::MetricDefinitions()[metric].decimals;
  Cell cell{FormatValue(ours.value, decimals), "", ""};
  if (!std::isnan(ours.lo))
    cell.interval = FormatValue(ours.lo, decimals) + "–" + FormatValue(ours.hi, decimals);
  if (const PaperCell paper = MakePaperCell(claims, table.arms[arm], metric); paper.value)
    cell.paper = (paper.value->approximate ? "~" : "") + paper.value->printed;
  return cell;
}

// The table as it is printed: arms down or across.
struct Grid {
  std::string corner;
  std::vector<std::string> columns, rows;
  std::vector<std::vector<Cell>> cells;
};

Grid MakeGrid(const StudyTable& table, const std::vector<paper::Claim>& claims) {
  Grid grid;
  std::vector<std::string> metrics;
  for (const std::size_t metric : table.metrics) metrics.push_back(MetricHeading(metric));
  grid.corner = table.arms_down ? "arm" : "metric";
  grid.rows = table.arms_down ? table.labels : metrics;
  grid.columns = table.arms_down ? metrics : table.labels;
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    std::vector<Cell>& row = grid.cells.emplace_back();
    for (std::size_t c = 0; c < grid.columns.size(); ++c)
      row.push_back(MakeCell(table, claims, table.arms_down ? r : c, table.metrics[table.arms_down ? c : r]));
  }
  return grid;
}

std::string Replace(std::string_view text,
                    std::span<const std::pair<std::string_view, std::string_view>> signs) {
  std::string out;
  while (!text.empty()) {
    std::string_view with = text.substr(0, 1);
    std::size_t length = 1;
    for (const auto& [sign, replacement] : signs)
      if (text.starts_with(sign)) with = replacement, length = sign.size();
    out += with;
    text.remove_prefix(length);
  }
  return out;
}

bool AnyPaper(const std::vector<Cell>& row) {
  for (const Cell& cell : row)
    if (!cell.paper.empty()) return true;
  return false;
}

}  // namespace

std::string LatexText(std::string_view utf8) {
  static constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"&", "\\&"},
      {"%", "\\%"},
      {"$", "\\$"},
      {"#", "\\#"},
      {"_", "\\_"},
      {"{", "\\{"},
      {"}", "\\}"},
      {"~", "\\textasciitilde{}"},
      {"^", "\\textasciicircum{}"},
      {"\\", "\\textbackslash{}"},
      {"²", "\\textsuperscript{2}"},
      {"³", "\\textsuperscript{3}"},
      {"–", "--"},
      {"η", "$\\eta$"},
      {"≥", "$\\geq$"},
      {"<", "\\textless{}"},
      {">", "\\textgreater{}"},
      {"|", "\\textbar{}"},
  };
  return Replace(utf8, kSigns);
}

std::string MarkdownText(std::string_view utf8) {
  static constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"|", "\\|"}, {"*", "\\*"}, {"_", "\\_"}, {"`", "\\`"}, {"<", "&lt;"}, {"\n", " "}};
  return Replace(utf8, kSigns);
}

std::string MarkdownTable(const StudyTable& table, const std::vector<paper::Claim>& claims) {
  const Grid grid = MakeGrid(table, claims);
  std::string text = fmt::format(
      "**{}.** 95 % intervals in parentheses, the paper's values in brackets.{}\n\n| {} |",
      MarkdownText(table.title), MarkdownText(table.note.empty() ? "" : ' ' + table.note), grid.corner);
  for (const std::string& column : grid.columns) text += ' ' + MarkdownText(column) + " |";
  text += "\n|---|";
  for (std::size_t c = 0; c < grid.columns.size(); ++c) text += "---|";
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    text += "\n| " + MarkdownText(grid.rows[r]) + " |";
    for (const Cell& cell : grid.cells[r]) {
      text += ' ' + cell.value;
      if (!cell.interval.empty()) text += " (" + cell.interval + ')';
      if (!cell.paper.empty()) text += " [" + cell.paper + ']';
      text += " |";
    }
  }
  return text + '\n';
}

std::string LatexTable(const StudyTable& table, const std::vector<paper::Claim>& claims) {
  const Grid grid = MakeGrid(table, claims);
  std::string text = fmt::format(
      "% needs \\usepackage{{booktabs}}\n\\begin{{table}}\n  \\centering\n  \\footnotesize\n"
      "  \\caption{{{}. Small: 95\\,\\% intervals; italic: the paper's values.{}}}\n  \\label{{tab:{}}}\n"
      "  \\begin{{tabular}}{{l{}}}\n    \\toprule\n    {}",
      LatexText(table.title), LatexText(table.note.empty() ? "" : ' ' + table.note), table.id,
      std::string(grid.columns.size(), 'r'), grid.corner);
  for (const std::string& column : grid.columns) text += " & " + LatexText(column);
  text += " \\\\\n    \\midrule\n";
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    text += "    " + LatexText(grid.rows[r]);
    for (const Cell& cell : grid.cells[r]) {
      text += " & " + LatexText(cell.value);
      if (!cell.interval.empty()) text += " {\\scriptsize " + LatexText(cell.interval) + '}';
    }
    text += " \\\\\n";
    if (!AnyPaper(grid.cells[r])) continue;
    text += "    \\quad\\textit{paper}";
    for (const Cell& cell : grid.cells[r])
      text += cell.paper.empty() ? " &" : " & \\textit{" + LatexText(cell.paper) + '}';
    text += " \\\\\n";
  }
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
}

std::string CsvTable(const StudyTable& table, const std::vector<paper::Claim>& claims) {
  std::string csv = "stage,arm,missions,metric,unit,value,lo,hi,n,paper\n";
  for (const metrics::ArmMetrics& arm : table.arms)
    for (const std::size_t metric : table.metrics) {
      const metrics::MetricValue& ours = arm.values[metric];
      const PaperCell paper = MakePaperCell(claims, arm, metric);
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", CsvField(arm.stage), CsvField(arm.name),
                         arm.missions, metrics::MetricDefinitions()[metric].name,
                         metrics::MetricDefinitions()[metric].unit, metrics::CsvNumber(ours.value),
                         metrics::CsvNumber(ours.lo), metrics::CsvNumber(ours.hi), ours.n,
                         paper.value ? paper.value->printed : "");
    }
  return csv;
}

nlohmann::ordered_json JsonTable(const StudyTable& table, const std::vector<paper::Claim>& claims) {
  nlohmann::ordered_json json = {{"id", table.id},
                                 {"title", table.title},
                                 {"note", table.note},
                                 {"arms", nlohmann::ordered_json::array()}};
  for (std::size_t a = 0; a < table.arms.size(); ++a) {
    const metrics::ArmMetrics& arm = table.arms[a];
    nlohmann::ordered_json entry = {
        {"stage", arm.stage}, {"arm", arm.name}, {"label", table.labels[a]}, {"missions", arm.missions}};
    for (const std::size_t metric : table.metrics) {
      const metrics::MetricValue& ours = arm.values[metric];
      const PaperCell paper = MakePaperCell(claims, arm, metric);
      entry[std::string(metrics::MetricDefinitions()[metric].name)] = {
          {"mean", metrics::JsonNumber(ours.value)},
          {"lo", metrics::JsonNumber(ours.lo)},
          {"hi", metrics::JsonNumber(ours.hi)},
          {"n", ours.n},
          {"paper",
           paper.value ? nlohmann::ordered_json(paper.value->value) : nlohmann::ordered_json(nullptr)}};
    }
    json["arms"].push_back(entry);
  }
  return json;
}

}  // namespace ed3r::tables
