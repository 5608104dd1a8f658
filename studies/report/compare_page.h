// The interactive page of two or more runs: their arms side by side, and what differs from the first, paired.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "studies/figures/run_source.h"
#include "studies/report/provenance.h"
#include "studies/report/report.h"

namespace ed3r::report {

struct ComparedRun {
  std::string label;
  RunResults results;  // without variants
  Provenance provenance;
  std::vector<figures::ArmPlan> plans;
  figures::FoundScene scene;  // that its arms flew in; of the first run alone
};

// The world of the arms, or why there is none.
figures::FoundScene SceneOf(store::ResultReader& reader, std::span<const figures::ArmPlan> plans);

// The document of page_data.h. Arms are keyed LABEL/STAGE/NAME; the paper's values stand beside each; claims are judged by the
// first run; `study` compares the others with it, and its differences are the page's answer; `departures` are sentences for its head. Tables and figures are none: each
// run's own report has them.
nlohmann::ordered_json ComparePageData(const std::vector<ComparedRun>& runs,
                                       const variants::VariantStudy& study,
                                       const std::vector<std::string>& departures,
                                       const std::string& command);

// One sentence on each run after the first: how many differences are certain, how many verdicts change.
std::vector<std::string> ComparisonSentences(const variants::VariantStudy& study);

}  // namespace ed3r::report
