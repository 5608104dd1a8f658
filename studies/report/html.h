// The report as a plain page: inline style, pictures by relative path, no scripts. It is index.html where the interactive
// page (web_page.h) cannot be made, and what that shows in browsers without scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/report/provenance.h"
#include "studies/report/report.h"

namespace ed3r::report {

struct PageInputs {
  const Report& report;
  const Provenance& provenance;
  nlohmann::ordered_json figures;  // "figures" of data.json, those of which the picture is there
  std::string figures_note;        // why there are none, or fewer than could be; "" where all are
  std::string report_command;      // that makes this page
};

std::string ReportPage(const PageInputs& inputs);

// The same without the document around it: its style, then its content.
std::string ReportContent(const PageInputs& inputs);

}  // namespace ed3r::report
