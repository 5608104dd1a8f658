// What came out, in sentences made from the numbers, for the first screen of the page.
#pragma once

#include <string>
#include <vector>

#include "studies/report/report.h"

namespace ed3r::report {

// `warmups`: names of arms that are no answer (parallel to report.told; true: left out). One to three sentences: the arm
// that the study is about (ed3r-75, else the one with the highest success rate) beside the random walk or the weakest;
// which arms the reader may prefer to it; what became of the paper's claims. Differences are called certain only where
// the 95 % intervals of the tables do not overlap. Empty without missions.
std::vector<std::string> AnswerSentences(const Report& report, const std::vector<bool>& warmups);

}  // namespace ed3r::report
