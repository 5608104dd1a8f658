#include "studies/report/report_folder.h"

#include <fmt/format.h>

#include <filesystem>

#include "engine/core/check.h"
#include "engine/core/file.h"
#include "engine/store/reader.h"
#include "engine/sweep/arm_id.h"
#include "studies/figures/draw.h"
#include "studies/figures/figure_data.h"
#include "studies/report/html.h"
#include "studies/report/page_data.h"
#include "studies/report/provenance.h"
#include "studies/report/web_page.h"

namespace ed3r::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "manifest.json";

// Of a sweep with variants: of the one that is told.
nlohmann::ordered_json FigureData(const Report& report, const RunResults& results, const std::string& dir) {
  store::ResultReader reader(dir);
  const std::string variant = report.variant;
  std::vector<figures::ArmPlan> plans = figures::ReadArmPlans(reader.StoredRecipe().plan_text);
  std::erase_if(plans,
                [&](const figures::ArmPlan& plan) { return sweep::ArmId::Of(plan.name).variant != variant; });
  std::vector<figures::ShownMission> missions = figures::PickMissions(reader, plans);
  figures::FoundScene found;
  for (const figures::ArmPlan& plan : plans)
    if (!missions.empty() && plan.stage == missions.front().stage && plan.name == missions.front().arm)
      found = figures::FindScene(reader, plan.Setting("mission.world"));
  for (figures::ArmPlan& plan : plans) plan.name = sweep::ArmId::Of(plan.name).name;
  for (figures::ShownMission& mission : missions) mission.arm = sweep::ArmId::Of(mission.arm).name;
  const std::vector<metrics::ArmData> arms = variants::ArmsOfVariant(results.arms, variant);
  return figures::MakeFigureData({.name = results.name,
                                  .arms = arms,
                                  .metrics = report.told,
                                  .plans = plans,
                                  .missions = missions,
                                  .scene = found.scene,
                                  .scene_note = found.why_not,
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

bool IsPlainName(const std::string& id) {
  return !id.empty() && id.find('/') == std::string::npos && id.find('\0') == std::string::npos;
}

// Pictures of an earlier report would be taken for this one's. Only those that a report lists are removed.
void RemovePictures(const fs::path& folder, const nlohmann::ordered_json& figures) {
  for (const auto& figure : figures) {
    if (!figure.is_object() || !figure.contains("id") || !figure["id"].is_string()) continue;
    const std::string id = figure["id"];
    std::error_code ignored;
    for (const char* ending : {".png", ".svg"})
      if (IsPlainName(id)) fs::remove(folder / (id + ending), ignored);
  }
}

void RemoveOldPictures(const fs::path& folder) {
  std::string text, ignored;
  if (!TryReadFile((folder / "data.json").string(), kMaxTextBytes, text, ignored)) return;
  const auto data = nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (data.is_object() && data.contains("figures")) RemovePictures(folder, data["figures"]);
}

std::string InteractivePage(const WebBundle& bundle, const PageInputs& plain, const RunResults& results,
                            const nlohmann::ordered_json& figures, const FolderOptions& options) {
  nlohmann::ordered_json broken = nlohmann::ordered_json::array();
  for (const auto& [mission, message] : plain.provenance.broken)
    broken.push_back({{"mission", mission}, {"message", message}});
  const PageMissions missions = ReadPageMissions(plain.report, results, options.dir);
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
  MakeFolder(base);
  for (const fs::path& folder : {base, base / "tables", figures}) RemoveLeftovers(folder);
  // First: a report that did not come to its end is known as one.
  WriteFile(base / kManifest, ManifestJson(provenance).dump(2) + '\n');
  WriteReport(report, options.out);
  MakeFolder(figures);
  const nlohmann::ordered_json data = FigureData(report, results, options.dir);
  RemoveOldPictures(figures);
  RemovePictures(figures, data.at("figures"));
  WriteFile(figures / "data.json", data.dump() + '\n');
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
