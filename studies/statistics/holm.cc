#include "studies/statistics/holm.h"

#include <algorithm>
#include <numeric>

#include "engine/core/check.h"

namespace ed3r::statistics {

std::vector<double> HolmAdjust(std::span<const double> p) {
  for (const double value : p) ED3R_CHECK(value >= 0 && value <= 1, "a probability");
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double least = 0;  // a larger p is never adjusted to less than a smaller one
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    least = std::max(least, std::min(1.0, static_cast<double>(p.size() - rank) * p[order[rank]]));
    adjusted[order[rank]] = least;
  }
  return adjusted;
}

}  // namespace ed3r::statistics
