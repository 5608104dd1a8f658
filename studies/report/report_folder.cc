#include "studies/report/report_folder.h"

#include <fmt/format.h>

#include <filesystem>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/remove_file.h"
#include "engine/core/files/temporary_file.h"
#include "engine/store/directory_lock.h"
#include "studies/figures/draw.h"
#include "studies/figures/figure_data.h"
#include "studies/report/html.h"
#include "studies/report/old_report.h"
#include "studies/report/page_data.h"
#include "studies/report/provenance.h"
#include "studies/report/web_page.h"

namespace ed3r::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "manifest.json";

nlohmann::ordered_json FigureData(const Report& report, const RunResults& results,
                                  const figures::RunSource& source) {
  const std::vector<metrics::ArmData> arms = variants::ArmsOfVariant(results.arms, report.variant);
  return figures::MakeFigureData({.name = results.name,
                                  .arms = arms,
                                  .metrics = report.told,
                                  .plans = source.plans,
                                  .missions = source.missions,
                                  .scene = source.scene.scene,
                                  .scene_note = source.scene.why_not,
                                  .variants = &report.variants});
}

// Titles and captions for whoever meets the pictures without index.html.
std::string CaptionsPage(const std::string& name, const nlohmann::ordered_json& listed,
                         const fs::path& folder) {
  std::string page = fmt::format(
      "# Figures of {}\n\n`ed3r report` draws them from data.json, which it writes beside them.\n", name);
  int number = 0;
  for (const auto& figure : listed) {
    const std::string id = figure.at("id"), title = figure.at("title"), caption = figure.at("caption");
    page += fmt::format("\n## Figure {}. {}\n\n", ++number, title);
    page += fs::exists(folder / (id + ".png")) ? fmt::format("![{}]({}.png)\n\n", title, id)
                                               : fmt::format("`{}`, not drawn.\n\n", id);
    page += caption + '\n';
  }
  return page;
}

// Files that a report may hold are replaced; anything else in its folder belongs to somebody.
bool IsReport(const fs::path& folder) {
  std::string text, ignored;
  if (!TryReadFile((folder / kManifest).string(), kMaxTextBytes, text, ignored)) return false;
  const auto manifest = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  return manifest.is_object() && manifest.contains("sweep") && manifest.contains("digest");
}

void CheckFolder(const fs::path& folder) {
  std::error_code error;
  const bool there = fs::exists(folder, error);
  if (!there || (fs::is_directory(folder, error) && fs::is_empty(folder, error)) || IsReport(folder)) return;
  throw UserError(
      fmt::format("{}: is there and is no report; --force writes the report's files into it all the same",
                  folder.string()));
}

std::string InteractivePage(const WebBundle& bundle, const PageInputs& plain, const RunResults& results,
                            const nlohmann::ordered_json& figures, const FolderOptions& options) {
  nlohmann::ordered_json broken = nlohmann::ordered_json::array();
  for (const auto& [mission, message] : plain.provenance.broken)
    broken.push_back({{"mission", mission}, {"message", message}});
  const PageMissions missions = PageMissionsOf(plain.report, results);
  const nlohmann::ordered_json data = MakePageData({.report = plain.report,
                                                    .provenance = plain.provenance,
                                                    .missions = missions,
                                                    .figures = figures,
                                                    .question = plain.provenance.question,
                                                    .report_command = plain.report_command,
                                                    .figures_note = plain.figures_note,
                                                    .broken = broken,
                                                    .viewers = options.viewers,
                                                    .viewers_note = options.viewers_note});
  return SelfContainedPage(plain.report.name + " – ED³R report", bundle, data, ReportContent(plain));
}

}  // namespace

FolderResult WriteReportFolder(const Report& report, const RunResults& results,
                               const FolderOptions& options) {
  const fs::path base(options.out), figures = base / "figures";
  if (!options.force) CheckFolder(base);
  const Provenance& provenance = options.provenance;
  const nlohmann::ordered_json data = FigureData(report, results, options.source);
  MakeFolder(base);
  const auto alone = store::LockToWrite(base.string());
  for (const fs::path& folder : {base, base / "tables", figures, base / "missions"}) RemoveLeftovers(folder);
  if (IsReport(base)) RemoveOldReport(base);  // in a folder of somebody's such names are his
  RemoveFile(base / "index.html");
  // First: a report that did not come to its end is known as one. index.html is missing then, which comes last.
  WriteFile(base / kManifest, ManifestJson(provenance).dump(2) + '\n');
  WriteReport(report, options.out);
  MakeFolder(figures);
  RemovePictures(figures, data.at("figures"));
  WriteFile(figures / "data.json", data.dump() + '\n');
  if (!options.mission_pages.empty()) MakeFolder(base / "missions");
  for (const auto& [name, page] : options.mission_pages) WriteFile(base / name, page);
  FolderResult result;
  if (!options.figures) {
    result.note = "figures not drawn (--no-figures)";
  } else if (const figures::DrawResult drawing = figures::DrawFigures(figures.string());
             drawing.outcome == figures::Drawing::kFailed) {
    result.plot_error = drawing.message;
  } else if (drawing.outcome == figures::Drawing::kUnavailable) {
    result.note = "figures not drawn: " + drawing.message;
  }
  nlohmann::ordered_json drawn = nlohmann::ordered_json::array();
  for (const auto& figure : data.at("figures"))
    if (fs::exists(figures / (figure.at("id").get<std::string>() + ".png"))) drawn.push_back(figure);
  WriteFile(figures / "README.md", CaptionsPage(results.name, data.at("figures"), figures));
  result.figures = static_cast<int>(drawn.size());
  const std::string note = result.plot_error.empty() ? result.note : "drawing failed: " + result.plot_error;
  const PageInputs plain{report, provenance, std::move(drawn), note, options.command};
  const FoundBundle found = FindWebBundle("report");
  result.page_note = found.why_not;
  WriteFile(base / "index.html",
            found.bundle ? InteractivePage(*found.bundle, plain, results, data, options) : ReportPage(plain));
  return result;
}

}  // namespace ed3r::report
