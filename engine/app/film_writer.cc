#include "engine/app/film_writer.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "engine/core/check.h"
#include "engine/core/shipped.h"
#include "engine/world/quiet_opencv.h"

namespace ed3r::app {
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

// Loaded once and never unloaded: codecs leave threads behind.
std::unique_ptr<VideoCodec> LoadCodec(const fs::path& film) {
  const fs::path beside = ProgramFolder() / "ed3r_video.so";
  std::error_code ignored;
  const fs::path library =
      fs::exists(beside, ignored) ? beside : ProgramFolder() / "../lib/ed3r/ed3r_video.so";
  void* loaded = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* made = loaded == nullptr ? nullptr : dlsym(loaded, kNewVideoCodec);
  if (made == nullptr)
    throw UserError(
        fmt::format("--video {}: the library of codecs cannot be loaded ({}); --html and --frames need none",
                    film.string(), dlerror()));
  return std::unique_ptr<VideoCodec>(reinterpret_cast<NewVideoCodec*>(made)());
}

}  // namespace

FilmWriter::FilmWriter(const fs::path& path, cv::Size size_px, double frames_per_second)
    : path_(path), size_px_(size_px) {
  ED3R_CHECK(size_px.width % 2 == 0 && size_px.height % 2 == 0, "a film's sides are even");
  if (path.extension() != ".mp4")
    throw UserError(fmt::format("--video {}: is not allowed; its name must end in .mp4", path.string()));
  world::QuietOpenCv();
  codec_ = LoadCodec(path);
  temporary_ = Temporary(path);
  if (codec_->Open(temporary_.string(), frames_per_second, size_px)) return;
  fs::remove(temporary_);
  throw UserError(fmt::format(
      "--video {}: OpenCV has no codec for it on this machine (tried H.264 and MPEG-4 of FFmpeg); "
      "--html and --frames need none",
      path.string()));
}

FilmWriter::~FilmWriter() {
  codec_.reset();
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void FilmWriter::Add(const cv::Mat& bgr) {
  ED3R_CHECK(bgr.size() == size_px_ && bgr.type() == CV_8UC3, "a frame of the film");
  codec_->Write(bgr);
  ++frames_;
}

void FilmWriter::Commit() {
  const int whole = codec_->Close();
  if (whole != frames_)
    CannotWrite(path_, fmt::format("{} of {} frames arrived; is the disk full?", whole, frames_));
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) CannotWrite(path_, error.message());
  temporary_.clear();
}

}  // namespace ed3r::app
