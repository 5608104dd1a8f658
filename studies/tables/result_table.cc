#include "studies/tables/result_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "studies/tables/paper_cell.h"

namespace ed3r::tables {
namespace {

constexpr int kLabelWidth = 24, kUnitWidth = 4;
constexpr std::string_view kArmGap = "   ", kCellGap = "  ";

// What one row shows of one arm. The ends of an interval are apart so that they line up at the dash.
struct Cell {
  std::string value, lo, hi, paper;
};

// A row of the table; a heading has no cells.
struct Row {
  std::string label, unit;
  std::function<Cell(const metrics::ArmMetrics&)> cell;
};

Cell MetricCell(const metrics::ArmMetrics& arm, std::size_t metric, const std::vector<paper::Claim>& claims) {
  const metrics::MetricValue& ours = arm.values[metric];
  const int decimals = metrics::MetricDefinitions()[metric].decimals;
  Cell cell{FormatValue(ours.value, decimals), "", "", ""};
  if (!std::isnan(ours.lo))
    cell.lo = FormatValue(ours.lo, decimals), cell.hi = FormatValue(ours.hi, decimals);
  cell.paper = MakePaperCell(claims, arm, metric).text;
  return cell;
}

std::vector<Row> MakeRows(const std::vector<paper::Claim>& claims) {
  const auto count = [](std::int64_t metrics::ArmMetrics::*member) {
    return [member](const metrics::ArmMetrics& arm) { return Cell{std::to_string(arm.*member), "", "", ""}; };
  };
  std::vector<Row> rows = {{"Missions", "", nullptr},
                           {"flown", "", count(&metrics::ArmMetrics::missions)},
                           {"failed in the program", "", count(&metrics::ArmMetrics::failed)},
                           {"still missing", "", count(&metrics::ArmMetrics::missing)}};
  const auto metrics = metrics::MetricDefinitions();
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    if (i == 0 || metrics[i].group != metrics[i - 1].group)
      rows.push_back({std::string(metrics::GroupTitle(metrics[i].group)), "", nullptr});
    rows.push_back({std::string(metrics[i].label), std::string(metrics[i].unit),
                    [i, &claims](const metrics::ArmMetrics& arm) { return MetricCell(arm, i, claims); }});
  }
  return rows;
}

// The cells of one arm, one per row, and how wide they are. The paper has a column where it has a value.
class ArmColumn {
 public:
  ArmColumn(const metrics::ArmMetrics& arm, const std::vector<Row>& rows) : name_(arm.name) {
    for (const Row& row : rows) cells_.push_back(row.cell ? row.cell(arm) : Cell{});
    for (const Cell& cell : cells_) {
      value_ = std::max(value_, DisplayWidth(cell.value));
      lo_ = std::max(lo_, DisplayWidth(cell.lo));
      hi_ = std::max(hi_, DisplayWidth(cell.hi));
      if (!cell.paper.empty()) paper_ = std::max({paper_, 5, DisplayWidth(cell.paper)});
    }
  }

  int Width() const { return std::max(DisplayWidth(name_), DisplayWidth(Join("", "", ""))); }
  std::string Name() const { return Pad(name_, Width(), Align::kCentre); }
  std::string Titles() const { return Fill(Join("ours", "interval", "paper")); }

  std::string Text(std::size_t row) const {
    const Cell& cell = cells_[row];
    const std::string interval =
        cell.lo.empty() ? "" : Pad(cell.lo, lo_, Align::kRight) + "–" + Pad(cell.hi, hi_, Align::kLeft);
    return Fill(Join(cell.value, interval, cell.paper));
  }

 private:
  std::string Fill(const std::string& text) const { return Pad(text, Width(), Align::kLeft); }

  std::string Join(std::string_view value, std::string_view interval, std::string_view paper) const {
    std::string text = Pad(value, value_, Align::kRight);
    text.append(kCellGap) += Pad(interval, std::max(8, lo_ + 1 + hi_), Align::kLeft);
    if (paper_ > 0) text.append(kCellGap) += Pad(paper, paper_, Align::kLeft);
    return text;
  }

  std::string name_;
  std::vector<Cell> cells_;
  int value_ = 5, lo_ = 0, hi_ = 0, paper_ = 0;
};

std::string Block(const std::vector<Row>& rows, std::span<const ArmColumn> columns) {
  const std::string margin(kLabelWidth + kUnitWidth, ' ');
  const auto line = [&](const std::string& start, const auto& text_of) {
    std::string text = start;
    for (const ArmColumn& column : columns) text.append(kArmGap) += text_of(column);
    return text + '\n';
  };
  std::string block = line(margin, [](const ArmColumn& c) { return c.Name(); }) +
                      line(margin, [](const ArmColumn& c) { return Rule(c.Width()); }) +
                      line(margin, [](const ArmColumn& c) { return c.Titles(); });
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!rows[r].cell) {
      block += rows[r].label + '\n';
      continue;
    }
    const std::string label =
        Pad("  " + rows[r].label, kLabelWidth, Align::kLeft) + Pad(rows[r].unit, kUnitWidth, Align::kRight);
    block += line(label, [r](const ArmColumn& c) { return c.Text(r); });
  }
  return TrimLineEnds(block);
}

// The arms of one stage, as many to a block as the width holds.
std::string Blocks(std::span<const metrics::ArmMetrics> arms, const std::vector<Row>& rows, int width) {
  std::vector<ArmColumn> columns;
  for (const metrics::ArmMetrics& arm : arms) columns.emplace_back(arm, rows);
  std::string text;
  for (std::size_t first = 0; first < columns.size();) {
    int used = kLabelWidth + kUnitWidth;
    std::size_t last = first;
    for (; last < columns.size(); ++last) {
      used += static_cast<int>(kArmGap.size()) + columns[last].Width();
      if (last > first && used > width) break;
    }
    text += '\n' + Block(rows, std::span(columns).subspan(first, last - first));
    first = last;
  }
  return text;
}

std::string PaperNotes(std::span<const metrics::ArmMetrics> arms, const std::vector<paper::Claim>& claims,
                       int width) {
  bool any = false, derived = false;
  std::vector<std::string> elsewhere;
  for (const metrics::ArmMetrics& arm : arms) {
    for (std::size_t i = 0; i < arm.values.size(); ++i) {
      const PaperCell cell = MakePaperCell(claims, arm, i);
      if (!cell.value) continue;
      any = true;
      derived = derived || cell.value->derived;
      if (!cell.value->elsewhere.empty())
        elsewhere.push_back(fmt::format("{} {} {}", arm.name, metrics::MetricDefinitions()[i].name,
                                        fmt::join(cell.value->elsewhere, ", ")));
    }
  }
  if (!any) return "";
  std::string notes = Wrap(
      "the value, give or take its rounding, lies in our interval. The paper gives no intervals of its own, "
      "so "
      "the absence of the mark is not a proven difference.",
      "✓ ", width);
  if (!elsewhere.empty())
    notes += Wrap(fmt::format("the paper prints another value elsewhere: {}.", fmt::join(elsewhere, "; ")),
                  "† ", width);
  if (derived)
    notes += Wrap("follows from what the paper prints, or from how the arm is built.", "‡ ", width);
  return notes;
}

std::string IntervalNotes(int width) {
  return Wrap(
      "Intervals hold 95 % and are over missions; where an arm flew with several trained networks "
      "(training.seeds) they are at least as wide as Student's t over the networks, with one network the "
      "luck "
      "of training is not in them. Means: Student's t. MSR, FP, BD and missions within 10 min: Wilson. MSCS, "
      "seconds per timestep and mean power, ratios of totals: linearised variance between missions. WER, OR, "
      "ER and model shares: Wilson with the effective sample size, because the timesteps of a mission are "
      "alike "
      "and WER rests on few missions (with fewer than 10 failed ones its upper end is too low). What 85 % of "
      "the "
      "missions stay under: order statistics. The longest mission has none. Look-forward accuracy is "
      "relative to "
      "the worst mission of the network, and so is its interval. – no value.",
      "", width);
}

}  // namespace

std::string ResultTable(std::span<const metrics::ArmMetrics> arms, const std::vector<paper::Claim>& claims,
                        int width) {
  if (arms.empty()) return "";
  const std::vector<Row> rows = MakeRows(claims);
  std::string text;
  for (std::size_t first = 0; first < arms.size();) {
    std::size_t last = first;
    while (last < arms.size() && arms[last].stage == arms[first].stage) ++last;
    if (first > 0) text += '\n';
    text += fmt::format("Stage {}\n", arms[first].stage);
    text += Blocks(arms.subspan(first, last - first), rows, width);
    first = last;
  }
  return text + '\n' + IntervalNotes(width) + PaperNotes(arms, claims, width);
}

}  // namespace ed3r::tables
