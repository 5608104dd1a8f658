// Verdicts for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "studies/claims/verdicts.h"

namespace ed3r::claims {

// A summary (how many of each verdict), a table of what was judged, and one line for each reason why claims
// were not measured; lines of at most kTerminalWidth characters. Empty where the run has none of the paper's
// arms.
std::string VerdictText(const ClaimStudy& study);

// [{"id", "where", "strategy", "metric", "kind", "claim", "paper", "ours", "lo", "hi", "p", "p_holm",
// "verdict", "why", "by_network": {"counts": {VERDICT: n}, "verdicts": [..], "ours": [..]}}]; null is "none".
// Empty where VerdictText is.
nlohmann::ordered_json VerdictJson(const ClaimStudy& study);

// The same as a table; the last columns are how many networks alone give each verdict. Only the heading where
// VerdictText is empty.
std::string VerdictCsv(const ClaimStudy& study);

// Columns claim,network,verdict,ours: by the missions of each network alone, of the claims that ask networks.
std::string ByNetworkCsv(const ClaimStudy& study);

// What is claimed in a few words, at most `width` characters.
std::string ClaimInWords(const paper::Claim& claim, int width);

}  // namespace ed3r::claims
