// The report of a run: its tables as text, CSV, JSON, Markdown and LaTeX. Reads nothing itself; load.h reads a run's
// store.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/claims/convergence.h"
#include "studies/claims/verdicts.h"
#include "studies/metrics/arm.h"
#include "studies/metrics/metrics.h"
#include "studies/report/departures.h"
#include "studies/tables/look_forward_table.h"
#include "studies/tables/result_table.h"
#include "studies/tables/study_table.h"
#include "studies/variants/arm_differences.h"
#include "studies/variants/variants.h"

namespace ed3r::report {

// What a run holds.
struct RunResults {
  std::string name;  // of the sweep
  std::vector<metrics::ArmData> arms;
  // The identities of the code, where several versions of it flew the run (CodeText); "" where one did.
  std::string mixed_code = {};
  bool unchecked = false;  // its missions have no checksums (format 1)
};

struct Report {
  std::string name;
  std::string mixed_code;  // as in RunResults
  bool unchecked = false;  // likewise
  RunDepartures departures;
  Judging judging = Judging::kWhatThePaperFlew;
  std::vector<metrics::ArmMetrics> arms;
  std::string variant;  // that tables, verdicts and pictures tell; "" without variants
  // What they tell: all arms, or those of that variant.
  std::vector<metrics::ArmMetrics> told;
  std::vector<tables::Generalisation> generalisation;  // one per arm told
  std::vector<tables::StudyTable> tables;              // for papers and pages
  claims::ClaimStudy claims;                         // without any where what is told departs from the paper
  std::vector<variants::ArmDifference> differences;  // of the arms told, in stages that no verdicts compare
  std::vector<std::string> difference_notes;         // which arms those leave out
  variants::VariantStudy variants;
  std::vector<std::string> variant_notes;             // which of them met other scenarios
  std::vector<claims::ConvergencePoint> convergence;  // of the arms told
  std::vector<tables::LookForward> look_forward;      // of the arms told that ask a network

  std::vector<std::string> DepartureNotes() const;  // for its head
};

// `departures`: of all variants (ReadDepartures); a variant that is not in it is taken for the paper's. Claims are judged
// as `judging` says, of variants only where all of them may be judged. `variant` is told, "" for the first. Throws UserError
// for one that the run has not.
Report MakeReport(const RunResults& results, const RunDepartures& departures,
                  Judging judging = Judging::kWhatThePaperFlew, const std::string& variant = "");

// The variant that MakeReport tells when `wanted` is asked for. Throws as it does.
std::string ToldVariant(const RunResults& results, const std::string& wanted);

// "Told here: the variant 'mass=2', 1 of 3 ..."; "" without variants.
std::string VariantNote(const Report& report);

// For a terminal of kTerminalWidth characters: heading, departures from the paper, result table, generalisation table, look-forward errors, differences of
// the arms, verdicts on the claims.
std::string ReportText(const Report& report);

// {"name", "paper": as DeparturesJson, "arms": as ResultJson, "generalisation": as GeneralisationJson, "differences": as
// ArmDifferenceJson, "claims": as VerdictJson}.
nlohmann::ordered_json ReportJson(const Report& report);

// Writes report.txt, report.json, metrics.csv, generalisation.csv, verdicts.csv, convergence.csv, look_forward.csv, where several networks flew
// by_network.csv, where arms are compared differences.csv, where there are variants variants.csv and variant_verdicts.csv, and tables/ID.md, .tex, .csv and .json of each table into `dir`, which it makes
// if it has to; each file is replaced whole or left as it was. Throws UserError when it cannot.
void WriteReport(const Report& report, const std::string& dir);

// All that WriteReport may write, below its folder.
const std::vector<std::string>& ReportFileNames();

}  // namespace ed3r::report
