#include "studies/detection/frame_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>

#include "engine/core/check.h"
#include "engine/core/csv_table.h"
#include "engine/core/file.h"
#include "engine/core/utf8.h"
#include "engine/world/picture_file.h"
#include "studies/detection/npy.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFrameBytes = std::uintmax_t{16} << 30;

std::vector<FrameLabel> ReadLabels(const std::string& path) {
  const CsvTable table = CsvTable::Read(path);
  constexpr double kBig = 1e9;
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
                      .view = static_cast<int>(table.Number(row, view, 0, kBig)),
                      .distance_m = table.Number(row, distance, 0, kBig),
                      .fire_px = table.Number(row, fire, 0, kBig),
                      .smoke_px = table.Number(row, smoke, 0, kBig),
                      .occluded = table.Number(row, occluded, 0, 1),
                      .positive = table.Number(row, label, 0, 1) != 0.0});
  }
  return labels;
}

bool IsPicture(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

NamedPicture ReadNamed(const fs::path& path) {
  const cv::Mat bgr = ReadPicture(path.string());
  NamedPicture picture{.name = path.filename().string(), .frame = {}};
  if (!IsUtf8(picture.name)) throw UserError(fmt::format("{}: its name is not UTF-8 text", path.string()));
  picture.frame = {.frames = 1, .width_px = bgr.cols, .height_px = bgr.rows, .rgb = {}};
  picture.frame.rgb.reserve(3 * bgr.total());
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; ++x)
      for (int c = 2; c >= 0; --c) picture.frame.rgb.push_back(bgr.at<cv::Vec3b>(y, x)[c]);
  return picture;
}

}  // namespace

bool IsFrameSet(const std::string& folder) { return fs::exists(fs::path(folder) / "frames.npy"); }

FrameSet ReadFrameSet(const std::string& folder) {
  const std::string csv = (fs::path(folder) / "labels.csv").string();
  const std::string npy = (fs::path(folder) / "frames.npy").string();
  FrameSet set{.frames = ParseNpy(ReadFile(npy, kMaxFrameBytes), npy), .labels = ReadLabels(csv)};
  if (set.labels.size() != static_cast<std::size_t>(set.frames.frames))
    throw UserError(fmt::format("{}: {} rows for {} frames", csv, set.labels.size(), set.frames.frames));
  return set;
}

std::vector<NamedPicture> ReadPictures(const std::string& path) {
  if (!fs::exists(path)) throw UserError(fmt::format("{}: no such file or folder", path));
  if (!fs::is_directory(path)) return {ReadNamed(path)};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path))
    if (IsPicture(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw UserError(fmt::format("{}: holds neither frames.npy nor pictures (.png, .jpg)", path));
  std::vector<NamedPicture> pictures;
  for (const fs::path& file : files) pictures.push_back(ReadNamed(file));
  return pictures;
}

}  // namespace ed3r
