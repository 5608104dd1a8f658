#include "studies/detection/frame_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "engine/core/check.h"
#include "studies/fit/csv_table.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

// The four numbers after 'shape': in NPY's header, which is a Python dictionary.
std::vector<std::size_t> Shape(const std::string& header, const std::string& path) {
  std::vector<std::size_t> shape;
  const std::size_t begin = header.find("'shape': ("), end = header.find(')', begin);
  if (begin != std::string::npos && end != std::string::npos)
    for (std::size_t i = begin + 10; i < end;) {
      std::size_t value = 0;
      const auto parsed = std::from_chars(header.data() + i, header.data() + end, value);
      if (parsed.ec == std::errc()) shape.push_back(value);
      i = std::max(i + 1, static_cast<std::size_t>(parsed.ptr - header.data()));
    }
  if (shape.size() != 4 || shape[3] != 3 || header.find("'descr': '|u1'") == std::string::npos ||
      header.find("'fortran_order': False") == std::string::npos)
    throw UserError(
        fmt::format("{}: a uint8 array of frames x height x width x 3 is wanted, not {}", path, header));
  return shape;
}

FrameStack ReadNpy(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string start(10, '\0');
  if (!file.read(start.data(), 10) || start.compare(0, 8, std::string("\x93NUMPY\x01\x00", 8)) != 0)
    throw UserError(fmt::format("{}: is no NPY 1.0 file", path));
  std::string header(static_cast<unsigned char>(start[8]) + 256u * static_cast<unsigned char>(start[9]),
                     '\0');
  file.read(header.data(), static_cast<std::streamsize>(header.size()));
  const std::vector<std::size_t> shape = Shape(header, path);
  const std::size_t bytes = shape[0] * shape[1] * shape[2] * shape[3];
  const std::uintmax_t size = fs::file_size(path);
  if (!file || size != 10 + header.size() + bytes || shape[0] > std::numeric_limits<int>::max())
    throw UserError(fmt::format("{}: is damaged: it has {} bytes, its header tells of {}", path, size,
                                10 + header.size() + bytes));
  FrameStack stack{.frames = static_cast<int>(shape[0]),
                   .width_px = static_cast<int>(shape[2]),
                   .height_px = static_cast<int>(shape[1]),
                   .rgb = std::vector<std::uint8_t>(bytes)};
  if (!file.read(reinterpret_cast<char*>(stack.rgb.data()), static_cast<std::streamsize>(bytes)))
    throw UserError(fmt::format("{}: cannot be read", path));
  return stack;
}

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
  for (std::size_t row = 0; row < table.rows(); ++row)
    labels.push_back({.world = std::string(table.Cell(row, world)),
                      .view = static_cast<int>(table.Number(row, view, 0, kBig)),
                      .distance_m = table.Number(row, distance, 0, kBig),
                      .fire_px = table.Number(row, fire, 0, kBig),
                      .smoke_px = table.Number(row, smoke, 0, kBig),
                      .occluded = table.Number(row, occluded, 0, 1),
                      .positive = table.Number(row, label, 0, 1) != 0.0});
  return labels;
}

bool IsPicture(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

NamedPicture ReadPicture(const fs::path& path) {
  const cv::Mat bgr = cv::imread(path.string(), cv::IMREAD_COLOR);
  if (bgr.empty()) throw UserError(fmt::format("{}: is no picture that can be read", path.string()));
  NamedPicture picture{.name = path.filename().string(), .frame = {}};
  picture.frame = {.frames = 1, .width_px = bgr.cols, .height_px = bgr.rows, .rgb = {}};
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; ++x)
      for (int c = 2; c >= 0; --c) picture.frame.rgb.push_back(bgr.at<cv::Vec3b>(y, x)[c]);
  return picture;
}

}  // namespace

bool IsFrameSet(const std::string& folder) { return fs::exists(fs::path(folder) / "frames.npy"); }

FrameSet ReadFrameSet(const std::string& folder) {
  const std::string csv = (fs::path(folder) / "labels.csv").string();
  FrameSet set{.frames = ReadNpy((fs::path(folder) / "frames.npy").string()), .labels = ReadLabels(csv)};
  if (set.labels.size() != static_cast<std::size_t>(set.frames.frames))
    throw UserError(fmt::format("{}: {} rows for {} frames", csv, set.labels.size(), set.frames.frames));
  return set;
}

std::vector<NamedPicture> ReadPictures(const std::string& path) {
  if (!fs::exists(path)) throw UserError(fmt::format("{}: no such file or folder", path));
  if (!fs::is_directory(path)) return {ReadPicture(path)};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path))
    if (IsPicture(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw UserError(fmt::format("{}: holds neither frames.npy nor pictures (.png, .jpg)", path));
  std::vector<NamedPicture> pictures;
  for (const fs::path& file : files) pictures.push_back(ReadPicture(file));
  return pictures;
}

}  // namespace ed3r
