#include "studies/report/old_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/files/file.h"
#include "engine/core/files/remove_file.h"
#include "studies/report/report.h"
#include "studies/report/web_page.h"

namespace ed3r::report {
namespace {

namespace fs = std::filesystem;

bool IsPlainName(const std::string& id) {
  return !id.empty() && id.find('/') == std::string::npos && id.find('\0') == std::string::npos;
}

void RemoveListedPictures(const fs::path& folder) {
  std::string text, ignored;
  if (!TryReadFile((folder / "data.json").string(), kMaxTextBytes, text, ignored)) return;
  const auto data = nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (data.is_object() && data.contains("figures")) RemovePictures(folder, data["figures"]);
}

// A page that somebody else has put there has another title, or another name.
bool IsMissionPage(const fs::path& page) {
  std::string text, ignored;
  if (page.extension() != ".html" || !TryReadFile(page.string(), kMaxTextBytes, text, ignored)) return false;
  const std::string opening = "<title>";
  const std::size_t begin = text.find(opening), end = text.find("</title>");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return false;
  std::string title = text.substr(begin + opening.size(), end - begin - opening.size());
  std::replace(title.begin(), title.end(), '/', '-');
  return title == page.stem().string() + kMissionTitle;
}

void RemoveMissionPages(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (IsMissionPage(entry->path())) found.push_back(entry->path());
  for (const fs::path& page : found) RemoveFile(page);
}

}  // namespace

void RemovePictures(const fs::path& folder, const nlohmann::ordered_json& figures) {
  for (const auto& figure : figures) {
    if (!figure.is_object() || !figure.contains("id") || !figure["id"].is_string()) continue;
    const std::string id = figure["id"];
    for (const char* ending : {".png", ".svg"})
      if (IsPlainName(id)) RemoveFile(folder / (id + ending));
  }
}

void RemoveOldReport(const fs::path& folder) {
  RemoveFile(folder / "index.html");
  for (const std::string& name : ReportFileNames()) RemoveFile(folder / name);
  const fs::path figures = folder / "figures";
  RemoveListedPictures(figures);
  for (const char* name : {"README.md", "plot.log", "data.json"}) RemoveFile(figures / name);
  RemoveMissionPages(folder / "missions");
}

}  // namespace ed3r::report
