#include "engine/app/film_writer.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <opencv2/videoio.hpp>
#include <string>

#include "engine/core/check.h"
#include "engine/world/quiet_opencv.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void CannotWrite(const fs::path& path, const std::string& why) {
  throw UserError(fmt::format("--video {}: cannot be written: {}", path.string(), why));
}

// A file of its own name beside `path`, so that nothing that stands there is written through.
fs::path Temporary(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status there = fs::symlink_status(path, ignored);
  if (fs::exists(there) && !fs::is_regular_file(there) && !fs::is_symlink(there))
    CannotWrite(path, "something other than a file stands there");
  std::string name = (path.parent_path() / fmt::format(".{}.XXXXXX.mp4", path.stem().string())).string();
  const int descriptor = mkstemps(name.data(), 4);
  if (descriptor < 0) CannotWrite(path, std::strerror(errno));
  close(descriptor);
  fs::permissions(
      name, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read | fs::perms::others_read,
      ignored);
  return name;
}

}  // namespace

FilmWriter::FilmWriter(const fs::path& path, cv::Size size_px, double frames_per_second)
    : path_(path), size_px_(size_px) {
  ED3R_CHECK(size_px.width % 2 == 0 && size_px.height % 2 == 0, "a film's sides are even");
  if (path.extension() != ".mp4")
    throw UserError(fmt::format("--video {}: is not allowed; its name must end in .mp4", path.string()));
  QuietOpenCv();
  temporary_ = Temporary(path);
  writer_ = std::make_unique<cv::VideoWriter>();
  for (const int codec :
       {cv::VideoWriter::fourcc('a', 'v', 'c', '1'), cv::VideoWriter::fourcc('m', 'p', '4', 'v')})
    if (writer_->open(temporary_.string(), cv::CAP_FFMPEG, codec, frames_per_second, size_px)) return;
  fs::remove(temporary_);
  throw UserError(fmt::format(
      "--video {}: OpenCV has no codec for it on this machine (tried H.264 and MPEG-4 of FFmpeg); "
      "--html and --frames need none",
      path.string()));
}

FilmWriter::~FilmWriter() {
  writer_.reset();
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void FilmWriter::Add(const cv::Mat& bgr) {
  ED3R_CHECK(bgr.size() == size_px_ && bgr.type() == CV_8UC3, "a frame of the film");
  writer_->write(bgr);
  ++frames_;
}

void FilmWriter::Commit() {
  writer_->release();
  // OpenCV does not tell of a full disk.
  cv::VideoCapture reader(temporary_.string(), cv::CAP_FFMPEG);
  const int whole = reader.isOpened() ? static_cast<int>(reader.get(cv::CAP_PROP_FRAME_COUNT)) : 0;
  if (whole != frames_)
    CannotWrite(path_, fmt::format("{} of {} frames arrived; is the disk full?", whole, frames_));
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) CannotWrite(path_, error.message());
  temporary_.clear();
}

}  // namespace ed3r
