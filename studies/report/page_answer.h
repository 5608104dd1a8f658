// What came out, in sentences made from the numbers, for the first screen of the page.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/report/report.h"

namespace ed3r::report {

// The arm that the study is about: ed3r-75, else the one with the highest success rate of those that are no warm-up. Null
// without missions. `warmups` as below.
const metrics::ArmMetrics* StudiedArm(const Report& report, const std::vector<bool>& warmups);

// `warmups`: arms that are no answer (true: left out); `missions`: theirs; both parallel to report.told. One to five sentences:
// the arm that the study is about beside the random walk or what the
// other arms are compared with; which arm has the best means and which ones the reader may prefer; what became of the
// paper's claims. Each difference is of the same scenarios, with its interval and its p value after Holm's correction: for all
// claims where one of them says it, else for all comparisons of arms. Empty without missions.
std::vector<std::string> AnswerSentences(const Report& report, const std::vector<bool>& warmups,
                                         std::span<const metrics::ArmData> missions);

}  // namespace ed3r::report
