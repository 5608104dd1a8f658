// Everything that `ed3r report` leaves in a folder.
#pragma once

#include <string>

#include "studies/report/report.h"

namespace ed3r {

struct FolderOptions {
  std::string dir;      // of the run
  std::string out;      // the report's folder, made where it is missing
  bool figures = true;  // draw them; their data are written in any case
  std::string command;  // that made it, for the page
};

struct FolderResult {
  int figures = 0;         // drawn
  std::string note;        // why figures are missing though nothing failed; "" where none is
  std::string plot_error;  // one line where drawing failed; the rest is there
};

// Writes what WriteReport does, manifest.json (provenance.h), figures/data.json (studies/figures/figure_data.h),
// figures/ID.png and .svg, figures/README.md with the title and caption of every figure, and index.html. Pictures that
// an earlier report left and this one does not make are removed. Throws UserError where the run cannot be read or the
// folder not be written.
FolderResult WriteReportFolder(const Report& report, const RunResults& results, const FolderOptions& options);

}  // namespace ed3r
