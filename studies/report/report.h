// The report of a run: its tables as text, CSV and JSON. Reads nothing itself; load.h reads a run's store.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/claims/convergence.h"
#include "studies/claims/verdicts.h"
#include "studies/metrics/arm.h"
#include "studies/metrics/metrics.h"
#include "studies/tables/result_table.h"

namespace ed3r {

// What a run holds.
struct RunResults {
  std::string name;  // of the sweep
  std::vector<ArmData> arms;
};

struct Report {
  std::string name;
  std::vector<ArmMetrics> arms;
  std::vector<Generalisation> generalisation;  // one per arm
  ClaimStudy claims;
  std::vector<ConvergencePoint> convergence;
};

Report MakeReport(const RunResults& results);

// For a terminal of kTerminalWidth characters: heading, result table, generalisation table, verdicts on the
// claims.
std::string ReportText(const Report& report);

// {"name", "arms": as ResultJson, "generalisation": as GeneralisationJson, "claims": as VerdictJson}.
nlohmann::ordered_json ReportJson(const Report& report);

// Writes report.txt, report.json, metrics.csv, generalisation.csv, verdicts.csv and convergence.csv into
// `dir`, which it makes if it has to; each file is replaced whole or left as it was. Throws UserError when it
// cannot.
void WriteReport(const Report& report, const std::string& dir);

}  // namespace ed3r
