// Everything that `ed3r report` leaves in a folder.
#pragma once

#include <map>
#include <string>

#include "studies/figures/run_source.h"
#include "studies/report/provenance.h"
#include "studies/report/report.h"

namespace ed3r::report {

struct FolderOptions {
  Provenance provenance;      // of the results (LoadWhole)
  figures::RunSource source;  // of the same moment, for figures
  std::string out;            // the report's folder, made where it is missing
  bool figures = true;        // draw them; their data are written in any case
  bool force = false;         // write into a folder that holds other things than a report
  std::string command;        // that made it, for the page
  // Mission viewers that the caller leaves in the folder: {"mission", "what", "file"}.
  nlohmann::ordered_json viewers = nlohmann::ordered_json::array();
  std::map<std::string, std::string> mission_pages =
      {};                         // those files: below the folder, and what is in them
  std::string viewers_note = {};  // why there are none, though they were wanted
};

struct FolderResult {
  int figures = 0;         // drawn
  std::string note;        // why figures are missing though nothing failed; "" where none is
  std::string page_note;   // why index.html is the plain page; "" where it is the interactive one
  std::string plot_error;  // one line where drawing failed; the rest is there
};

// Writes what WriteReport does, manifest.json (provenance.h), figures/data.json (studies/figures/figure_data.h),
// figures/ID.png and .svg, figures/README.md with the title and caption of every figure, the mission pages, and index.html: one file
// with everything in it (web_page.h), or the plain page (html.h) where its program is not at hand. What an earlier report left there is taken
// away before (old_report.h), no other files are; index.html is written last, so that a report that has one is whole. Throws UserError where the
// folder cannot be written, or where it is not empty and no report (without a manifest.json of one).
FolderResult WriteReportFolder(const Report& report, const RunResults& results, const FolderOptions& options);

}  // namespace ed3r::report
