#include "studies/detection/frame_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/files/csv_table.h"
#include "engine/core/files/file.h"
#include "engine/core/files/utf8.h"
#include "engine/core/sha256.h"
#include "engine/world/files/picture_file.h"

namespace ed3r::detection {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFrameBytes = std::uintmax_t{16} << 30;

// Frames and rows go together by their order alone: a table that was sorted otherwise, or that has one row twice and
// lacks another, would label other frames.
void CheckOrder(const CsvTable& table) {
  const auto is_index = [](std::string name) {
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    return name == "index";
  };
  const auto column = std::find_if(table.columns().begin(), table.columns().end(), is_index);
  if (column == table.columns().end()) return;
  const auto index = static_cast<std::size_t>(column - table.columns().begin());
  constexpr double kBig = 1e9;
  double above = -1.0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double number = table.Number(row, index, 0, kBig);
    if (number <= above)
      throw UserError(fmt::format(
          "{}{} stands below {}; allowed: rows in the order of their frames, each once; sort them by index",
          table.Where(row, index), table.Cell(row, index), table.Cell(row - 1, index)));
    above = number;
  }
}

int WholeNumber(const CsvTable& table, std::size_t row, std::size_t column, int max) {
  const double number = table.Number(row, column, 0, max);
  if (number != std::floor(number))
    throw UserError(fmt::format("{}{} is not allowed; allowed: a whole number of 0 .. {}",
                                table.Where(row, column), table.Cell(row, column), max));
  return static_cast<int>(number);
}

std::vector<FrameLabel> ReadLabels(const std::string& path) {
  const CsvTable table = CsvTable::Read(path);
  CheckOrder(table);
  constexpr int kBig = 1'000'000'000;
  const std::size_t world = table.Column("world", "the world's name"),
                    view = table.Column("view", "the view's number"),
                    distance = table.Column("distance_m", "the distance to the fire"),
                    fire = table.Column("fire_px", "visible fire"),
                    smoke = table.Column("smoke_px", "visible smoke"),
                    occluded = table.Column("occluded", "the hidden share"),
                    label = table.Column("label", "whether fire or smoke is in view");
  std::vector<FrameLabel> labels;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!IsUtf8(table.Cell(row, world)))
      throw UserError(fmt::format("{}not UTF-8 text", table.Where(row, world)));
    labels.push_back({.world = std::string(table.Cell(row, world)),
                      .view = WholeNumber(table, row, view, kBig),
                      .distance_m = table.Number(row, distance, 0, kBig),
                      .fire_px = table.Number(row, fire, 0, kBig),
                      .smoke_px = table.Number(row, smoke, 0, kBig),
                      .occluded = table.Number(row, occluded, 0, 1),
                      .positive = WholeNumber(table, row, label, 1) == 1});
  }
  return labels;
}

bool IsPicture(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

// Against what the set's manifest says of the file, where it says anything: sets of others have none.
void CheckOfManifest(const nlohmann::json& manifest, const char* key, const std::string& file,
                     const std::string& bytes) {
  const auto said = manifest.find(key);
  if (said == manifest.end()) return;
  Sha256 sha;
  sha.Update(bytes);
  if (const std::string found = sha.Hex(); !said->is_string() || *said != found)
    throw UserError(fmt::format(
        "{}: not the file of the manifest.json beside it (SHA-256 {}, there {}); render the set again, "
        "or take the manifest away where the file was changed on purpose",
        file, found, said->dump()));
}

nlohmann::json ReadManifest(const std::string& folder) {
  const std::string path = (fs::path(folder) / "manifest.json").string();
  std::error_code error;  // a link that leads nowhere is no missing manifest
  if (!fs::exists(fs::symlink_status(path, error))) return nlohmann::json::object();
  nlohmann::json manifest = nlohmann::json::parse(ReadFile(path, kMaxTextBytes), nullptr, false);
  if (manifest.is_discarded())
    throw UserError(fmt::format("{}: no JSON; take it away to read the set without", path));
  if (!manifest.is_object())
    throw UserError(fmt::format("{}: is {}, not a JSON object; take it away to read the set without", path,
                                manifest.type_name()));
  return manifest;
}

}  // namespace

bool IsFrameSet(const std::string& folder) { return fs::exists(fs::path(folder) / "frames.npy"); }

FrameSet ReadFrameSet(const std::string& folder) {
  const std::string csv = (fs::path(folder) / "labels.csv").string();
  const std::string npy = (fs::path(folder) / "frames.npy").string();
  const nlohmann::json manifest = ReadManifest(folder);
  CheckOfManifest(manifest, "labels_csv_sha256", csv, ReadFile(csv, kMaxFrameBytes));
  std::string bytes = ReadFile(npy, kMaxFrameBytes);
  CheckOfManifest(manifest, "frames_npy_sha256", npy, bytes);
  FrameSet set{.frames = NpyFrames(std::move(bytes), npy), .labels = ReadLabels(csv)};
  if (set.labels.size() != static_cast<std::size_t>(set.frames.frames()))
    throw UserError(fmt::format("{}: {} rows for {} frames", csv, set.labels.size(), set.frames.frames()));
  return set;
}

PictureList ListPictures(const std::string& path) {
  if (!fs::exists(path)) throw UserError(fmt::format("{}: no such file or folder", path));
  PictureList list;
  if (!fs::is_directory(path)) {
    list.paths.push_back(path);
    return list;
  }
  std::string below;  // a folder that is perhaps meant
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (entry.is_directory()) {
      below = std::max(below, entry.path().filename().string());
    } else if (IsPicture(entry.path())) {
      list.paths.push_back(entry.path().string());
    } else {
      ++list.passed_over;
    }
  }
  std::sort(list.paths.begin(), list.paths.end());
  if (list.paths.empty())
    throw UserError(fmt::format(
        "{}: holds neither frames.npy nor pictures (.png, .jpg, .jpeg){}", path,
        below.empty() ? "" : fmt::format("; folders within, such as '{}', are looked at one by one", below)));
  return list;
}

NamedPicture ReadNamedPicture(const std::string& path) {
  NamedPicture named{.name = fs::path(path).filename().string(), .note = {}, .frame = {}};
  if (!IsUtf8(named.name)) throw UserError(fmt::format("{}: its name is not UTF-8 text", path));
  world::Picture picture = world::ReadPicture(path);
  const cv::Mat& bgr = picture.bgr;
  named.note = std::move(picture.note);
  named.frame = {.frames = 1, .width_px = bgr.cols, .height_px = bgr.rows, .rgb = {}};
  named.frame.rgb.reserve(3 * bgr.total());
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; ++x)
      for (int c = 2; c >= 0; --c) named.frame.rgb.push_back(bgr.at<cv::Vec3b>(y, x)[c]);
  return named;
}

}  // namespace ed3r::detection
