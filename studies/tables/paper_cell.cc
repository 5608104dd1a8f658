#include "studies/tables/paper_cell.h"

#include <cmath>

namespace ed3r::tables {

PaperCell MakePaperCell(const std::vector<paper::Claim>& claims, const metrics::ArmMetrics& arm,
                        std::size_t metric) {
  PaperCell cell;
  cell.value = paper::FindPaperValue(claims, arm.name, metrics::MetricDefinitions()[metric].name);
  if (!cell.value) return cell;
  const paper::PaperValue& paper = *cell.value;
  const metrics::MetricValue& ours = arm.values[metric];
  // False for NaN: no interval, no agreement.
  cell.within = ours.lo - paper.half_unit <= paper.value && paper.value <= ours.hi + paper.half_unit;
  cell.text = (paper.approximate ? "~" : "") + paper.printed;
  if (cell.within) cell.text += "✓";
  if (!paper.elsewhere.empty()) cell.text += "†";
  if (paper.derived) cell.text += "‡";
  return cell;
}

}  // namespace ed3r::tables
