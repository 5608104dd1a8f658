#include "studies/report/report.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "engine/core/check.h"
#include "studies/claims/verdict_tables.h"
#include "studies/paper/claims.h"
#include "studies/tables/data_files.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

void WriteFile(const fs::path& path, const std::string& text) {
  const fs::path unfinished = path.string() + ".tmp";
  std::ofstream file(unfinished, std::ios::binary);
  file << text;
  file.close();
  std::error_code error;
  if (file) fs::rename(unfinished, path, error);
  if (!file || error) throw UserError(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

Report MakeReport(const RunResults& results) {
  Report report{results.name, {}, {}, JudgeClaims(PaperClaims(), results.arms), Convergence(results.arms)};
  for (const ArmData& arm : results.arms) {
    report.arms.push_back(ComputeMetrics(arm));
    report.generalisation.push_back(ComputeGeneralisation(arm));
  }
  return report;
}

std::string ReportText(const Report& report) {
  std::string text = report.name + "\n\n";
  if (report.arms.empty()) return text + "No missions.\n";
  text += ResultTable(report.arms, PaperClaims());
  const std::string generalisation = GeneralisationTable(report.generalisation);
  if (!generalisation.empty()) text += '\n' + generalisation;
  const std::string verdicts = VerdictText(report.claims);
  return verdicts.empty() ? text : text + '\n' + verdicts;
}

nlohmann::ordered_json ReportJson(const Report& report) {
  nlohmann::ordered_json json = {{"name", report.name}};
  json.update(ResultJson(report.arms, PaperClaims()));
  json["generalisation"] = GeneralisationJson(report.generalisation);
  json["claims"] = VerdictJson(report.claims);
  return json;
}

void WriteReport(const Report& report, const std::string& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw UserError(fmt::format("{}: cannot be made: {}", dir, error.message()));
  const fs::path base(dir);
  WriteFile(base / "report.txt", ReportText(report));
  WriteFile(base / "report.json", ReportJson(report).dump(2) + '\n');
  WriteFile(base / "metrics.csv", ResultCsv(report.arms, PaperClaims()));
  WriteFile(base / "generalisation.csv", GeneralisationCsv(report.generalisation));
  WriteFile(base / "verdicts.csv", VerdictCsv(report.claims));
  WriteFile(base / "convergence.csv", ConvergenceCsv(report.convergence));
}

}  // namespace ed3r
