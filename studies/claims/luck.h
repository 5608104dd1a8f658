// The luck of training: may one network, as the paper seems to have trained, give what the paper prints though ours differ
// from it on average?
#pragma once

#include "studies/claims/verdicts.h"

namespace ed3r::claims {

// Where one more network's value, judged on as many missions as the paper's, would lie with 95 % (prediction interval over our
// networks; on the logit scale for percentages of one arm). kTooWide: the band is so wide, more than kWidestLuck margins, that
// it would hold almost anything. kUnknown: fewer than two networks.
inline constexpr double kWidestLuck = 4.0;
Luck LuckOf(const JudgedClaim& judged);

}  // namespace ed3r::claims
