// The paper's value beside ours, and what its marks mean.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "studies/metrics/metrics.h"
#include "studies/paper/claims.h"

namespace ed3r::tables {

struct PaperCell {
  std::string text;     // "21.44✓†", "~18"; empty where the paper gives nothing
  bool within = false;  // ✓: our interval holds it, give or take its rounding
  std::optional<paper::PaperValue> value;
};

// What the paper gives for metric number `metric` of `arm`. ✓ needs an interval of ours; † the paper prints
// another value elsewhere; ‡ derived, not printed; ~ printed as "about".
PaperCell MakePaperCell(const std::vector<paper::Claim>& claims, const metrics::ArmMetrics& arm,
                        std::size_t metric);

}  // namespace ed3r::tables
