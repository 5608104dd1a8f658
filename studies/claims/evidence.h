// What a run says about one claim, before any verdict: internal to studies/claims.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "studies/claims/expression.h"
#include "studies/claims/resampled_arms.h"
#include "studies/paper/claims.h"

namespace ed3r::claims {

inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

struct Evidence {
  double ours = kNoNumber, lo = kNoNumber, hi = kNoNumber;  // 95 %; NaN: too few missions to tell
  bool exact = false;  // a fact of these missions that has no interval: the longest of them
  double paper = kNoNumber;
  // Of the claim's direction and of the opposite; only where it has one (orders, comparisons).
  bool directional = false;
  double p_for = kNoNumber, p_against = kNoNumber;
  bool sizes_agree = false;  // orders: the paper prints every difference, and all are equivalent to ours
  // Standard error over missions, as many as flew and as many as the paper's; not of orders.
  double own_sd = kNoNumber, paper_sd = kNoNumber;
  std::int64_t missions = 0;  // of the arm with the fewest; not of orders
  std::string detail;         // orders: the least certain part
};

// An order or similarity. All arms must be there.
Evidence WeighOrder(const paper::Claim& claim, const Formula& formula, const ResampledArms& arms,
                    const std::vector<paper::Claim>& claims);

// A number of one or several arms, or a comparison ("ratio"). All arms must be there.
Evidence WeighNumber(const paper::Claim& claim, const Quantity& quantity, const ResampledArms& arms);

}  // namespace ed3r::claims
