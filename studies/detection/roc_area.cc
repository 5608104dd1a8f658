#include "studies/detection/roc_area.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

#include "engine/core/check.h"

namespace ed3r::detection {

RocArea::RocArea(std::span<const double> confidences, std::span<const FrameLabel> labels,
                 const std::vector<std::size_t>& chosen, std::span<const int> unit_of_chosen) {
  ED3R_CHECK(confidences.size() == labels.size(), "one confidence per frame");
  ED3R_CHECK(chosen.size() == unit_of_chosen.size(), "one unit per chosen frame");
  std::vector<std::size_t> order(chosen.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto confidence = [&](std::size_t c) { return confidences[chosen[c]]; };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return confidence(a) < confidence(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    frames_.push_back({.unit = unit_of_chosen[order[i]],
                       .positive = labels[chosen[order[i]]].positive,
                       .tied = i > 0 && confidence(order[i]) == confidence(order[i - 1])});
}

double RocArea::Of(std::span<const int> count_of_unit) const {
  // Whole numbers, so that equal frames give equal areas to the last bit.
  std::int64_t positives = 0, negatives = 0, half_pairs = 0;
  std::int64_t tied_positives = 0, tied_negatives = 0;
  const auto close_ties = [&] {
    half_pairs += tied_positives * (2 * negatives + tied_negatives);
    positives += tied_positives, negatives += tied_negatives;
    tied_positives = tied_negatives = 0;
  };
  for (const Frame& frame : frames_) {
    if (!frame.tied) close_ties();
    (frame.positive ? tied_positives : tied_negatives) += count_of_unit[static_cast<std::size_t>(frame.unit)];
  }
  close_ties();
  if (positives == 0 || negatives == 0) return std::numeric_limits<double>::quiet_NaN();
  return 0.5 * static_cast<double>(half_pairs) /
         (static_cast<double>(positives) * static_cast<double>(negatives));
}

}  // namespace ed3r::detection
