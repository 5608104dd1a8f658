#include "studies/report/report_folder.h"

#include <fmt/format.h>

#include <filesystem>

#include "studies/figures/draw.h"
#include "studies/figures/figure_data.h"
#include "studies/report/files.h"
#include "studies/report/html.h"
#include "studies/report/provenance.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

// Of a sweep with variants: of its first one.
nlohmann::ordered_json FigureData(const Report& report, const RunResults& results, const std::string& dir) {
  ResultReader reader(dir);
  const std::vector<std::string>& variants = report.variants.variants;
  const std::string ending = variants.empty() ? "" : "@" + variants.front();
  std::vector<ArmPlan> plans = ReadArmPlans(reader.StoredRecipe().plan_text);
  std::erase_if(plans, [&](const ArmPlan& plan) { return !plan.name.ends_with(ending); });
  std::vector<ShownMission> missions = PickMissions(reader, plans);
  FoundScene found;
  for (const ArmPlan& plan : plans)
    if (!missions.empty() && plan.stage == missions.front().stage && plan.name == missions.front().arm)
      found = FindScene(reader, plan.Setting("mission.world"));
  for (ArmPlan& plan : plans) plan.name.resize(plan.name.size() - ending.size());
  for (ShownMission& mission : missions) mission.arm.resize(mission.arm.size() - ending.size());
  const std::vector<ArmData> arms =
      variants.empty() ? results.arms : ArmsOfVariant(results.arms, variants.front());
  return MakeFigureData({.name = results.name,
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

// Pictures of an earlier report would be taken for this one's.
void RemovePictures(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".png" || entry.path().extension() == ".svg")
      fs::remove(entry.path(), error);
}

}  // namespace

FolderResult WriteReportFolder(const Report& report, const RunResults& results,
                               const FolderOptions& options) {
  const fs::path base(options.out), figures = base / "figures";
  WriteReport(report, options.out);
  MakeFolder(figures);
  const nlohmann::ordered_json data = FigureData(report, results, options.dir);
  WriteWhole(figures / "data.json", data.dump() + '\n');
  RemovePictures(figures);
  FolderResult result;
  if (!options.figures) {
    result.note = "figures not drawn (--no-figures)";
  } else if (const DrawResult drawing = DrawFigures(figures.string()); drawing.outcome == Drawing::kFailed) {
    result.plot_error = drawing.message;
  } else if (drawing.outcome == Drawing::kUnavailable) {
    result.note = "figures not drawn: " + drawing.message;
  }
  nlohmann::ordered_json drawn = nlohmann::ordered_json::array();
  for (const auto& figure : data.at("figures"))
    if (fs::exists(figures / (figure.at("id").get<std::string>() + ".png"))) drawn.push_back(figure);
  WriteWhole(figures / "README.md", CaptionsPage(results.name, data.at("figures"), figures));
  result.figures = static_cast<int>(drawn.size());
  const std::string note = result.plot_error.empty() ? result.note : "drawing failed: " + result.plot_error;
  const Provenance provenance = ReadProvenance(options.dir);
  WriteWhole(base / "manifest.json", ManifestJson(provenance).dump(2) + '\n');
  WriteWhole(base / "index.html", ReportPage({report, provenance, std::move(drawn), note, options.command}));
  return result;
}

}  // namespace ed3r
