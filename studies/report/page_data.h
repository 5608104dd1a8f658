// What the interactive page shows, as one JSON document that is inlined into it. Its reader is studies/report/web/.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "studies/report/provenance.h"
#include "studies/report/report.h"

namespace ed3r::report {

struct PageMissions {
  std::vector<metrics::ArmData> arms;     // those that the report tells, in its order
  std::vector<std::vector<int>> numbers;  // of their missions, for `ed3r replay`
  std::string variant;                    // that the store has these arms under; mostly ""
};

// The missions of the arms told, with their numbers. `results`: of a store (load.h).
PageMissions PageMissionsOf(const Report& report, const RunResults& results);

struct PageDataInputs {
  const Report& report;
  const Provenance& provenance;
  const PageMissions& missions;
  const nlohmann::ordered_json& figures;  // the document of studies/figures/figure_data.h
  std::string question;                   // of the study; "" where it is not known
  std::string report_command;
  std::string figures_note;
  // Missions that failed inside the program: {"mission", "message"}.
  nlohmann::ordered_json broken = nlohmann::ordered_json::array();
  // Mission viewers beside the page: {"mission", "what", "file"}.
  nlohmann::ordered_json viewers = nlohmann::ordered_json::array();
  std::string viewers_note = {};  // why there are none, though they were wanted
};

// {"format", "name", "question", "answer": [sentences], "departures": [sentences], "metrics", "arms", "studied" (arm), "slices", "histograms", "points", "failures",
// "known_sites", "broken", "claims", "differences", "tables", "world", "missions_shown", "variants", "figures", "run": provenance for people,
// "viewers", "viewers_note"}; parts as in page_slices.h and figure_data.h. Pure.
nlohmann::ordered_json MakePageData(const PageDataInputs& inputs);

}  // namespace ed3r::report
