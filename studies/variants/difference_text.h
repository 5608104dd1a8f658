// Differences as cells of a table.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "studies/metrics/definitions.h"
#include "studies/variants/paired.h"

namespace ed3r::variants {

// "total energy, kJ".
inline std::string DifferenceHeading(const char* metric) {
  const metrics::MetricDefinition& definition = metrics::MetricDefinitions()[metrics::MetricIndex(metric)];
  return fmt::format("{}, {}", definition.label, definition.unit);
}

// "-3.2* [-4.0, -2.4]": a star where it is certain, a question mark where one network flew on a side.
inline std::string DifferenceCell(const PairedDifference& d, bool certain) {
  if (std::isnan(d.difference)) return "–";
  if (std::isnan(d.lo)) return fmt::format("{:+.1f}", d.difference);
  return fmt::format("{:+.1f}{} [{:+.1f}, {:+.1f}]", d.difference,
                     certain          ? "*"
                     : d.OneNetwork() ? "?"
                                      : "",
                     d.lo, d.hi);
}

// "0.034", "<0.001", "–" for none.
inline std::string PText(double p) {
  if (std::isnan(p)) return "–";
  return p < 0.001 ? "<0.001" : fmt::format("{:.3f}", p);
}

// What the question mark stands for.
inline constexpr const char* kOneNetworkNote =
    "one trained network on a side: the luck of training is not in the interval.";

}  // namespace ed3r::variants
