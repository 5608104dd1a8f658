// Verdicts for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

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

// What the verdicts mean, with the margins, in sentences.
std::string VerdictRules();
// What corrected p values and intervals of each claim alone have to do with each other; "" without directional claims.
std::string CorrectionNote(const ClaimStudy& study);
// What "(luck)" and "(luck?)" stand for.
std::string LuckNote();
// Whether a claim compares P85 groups of several arms, and what its reader must know of them, from the study's own success
// rates; "" where none was judged.
bool ComparesP85(const JudgedClaim& judged);
std::string P85ClaimNote(const ClaimStudy& study);
// {same, measured}: of the networks whose own missions are enough for a verdict those that give the claim's; zeros where the
// claim asks none or none has enough.
std::pair<int, int> AgreeingNetworks(const JudgedClaim& judged);
// Whether a claim of an order or of a sign came out nearer to its opposite, certain or not.
bool PointsTheOtherWay(const JudgedClaim& judged);

// What is claimed in a few words, at most `width` characters.
std::string ClaimInWords(const paper::Claim& claim, int width);

}  // namespace ed3r::claims
