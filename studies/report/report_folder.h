// Everything that `ed3r report` leaves in a folder.
#pragma once

#include <string>

#include "studies/report/provenance.h"
#include "studies/report/report.h"

namespace ed3r::report {

struct FolderOptions {
  std::string dir;        // of the run's store
  Provenance provenance;  // of the results (LoadWhole)
  std::string out;        // the report's folder, made where it is missing
  bool figures = true;    // draw them; their data are written in any case
  bool force = false;     // write into a folder that holds other things than a report
  std::string command;    // that made it, for the page
  // Mission viewers that the caller leaves in the folder: {"mission", "what", "file"}.
  nlohmann::ordered_json viewers = nlohmann::ordered_json::array();
  std::string viewers_note = {};  // why there are none, though they were wanted
};

struct FolderResult {
  int figures = 0;         // drawn
  std::string note;        // why figures are missing though nothing failed; "" where none is
  std::string page_note;   // why index.html is the plain page; "" where it is the interactive one
  std::string plot_error;  // one line where drawing failed; the rest is there
};

// Writes what WriteReport does, manifest.json (provenance.h), figures/data.json (studies/figures/figure_data.h),
// figures/ID.png and .svg, figures/README.md with the title and caption of every figure, and index.html: one file with everything in it (web_page.h),
// or the plain page (html.h) where its program is not at hand. Of the pictures
// there, those that an earlier report lists in its data.json are removed, no others. Throws UserError where the run cannot
// be read, the folder not be written, or where it is not empty and no report (without a manifest.json of one).
FolderResult WriteReportFolder(const Report& report, const RunResults& results, const FolderOptions& options);

}  // namespace ed3r::report
