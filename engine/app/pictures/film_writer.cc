#include "engine/app/pictures/film_writer.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <system_error>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/shipped.h"
#include "engine/core/files/temporary_file.h"
#include "engine/core/temporary.h"
#include "engine/world/files/quiet_opencv.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

std::string Called(const fs::path& path) { return fmt::format("--video {}", path.string()); }

// Room that the next frames and the film's end may take.
constexpr off_t kRoomBytes = 1 << 20;

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
  file_.emplace(path, Called(path));
  if (codec_->Open(file_->path.string(), frames_per_second, size_px)) return;
  file_->CheckRoom(Called(path));
  throw UserError(
      fmt::format("{}: OpenCV has no codec for it on this machine (tried H.264 and MPEG-4 of "
                  "FFmpeg); --html and --frames need none",
                  Called(path)));
}

FilmWriter::~FilmWriter() { codec_.reset(); }

FilmWriter::Temporary::Temporary(const fs::path& film, const std::string& called) {
  std::error_code ignored;
  const fs::file_status there = fs::symlink_status(film, ignored);
  if (fs::exists(there) && !fs::is_regular_file(there) && !fs::is_symlink(there))
    throw UserError(fmt::format("{}: cannot be written: something other than a file stands there", called));
  const fs::path folder = film.parent_path();
  RemoveLeftovers(folder.empty() ? "." : folder);
  descriptor = MakeTemporaryFile(folder, kTemporaryFilm, path);
  if (descriptor < 0) FailToWrite(called, errno);
}

FilmWriter::Temporary::~Temporary() {
  close(descriptor);
  unlink(path.c_str());  // where it has become the film, the name is nobody's
  KeepOnSignal(path);
}

void FilmWriter::Temporary::CheckRoom(const std::string& called) const {
  const int error = posix_fallocate(descriptor, lseek(descriptor, 0, SEEK_END), kRoomBytes);
  if (error != 0) FailToWrite(called, error);
}

void FilmWriter::Add(const cv::Mat& bgr) {
  ED3R_CHECK(bgr.size() == size_px_ && bgr.type() == CV_8UC3, "a frame of the film");
  codec_->Write(bgr);
  ++frames_;
}

void FilmWriter::Commit() {
  const int whole = codec_->Close();
  if (whole != frames_) {
    file_->CheckRoom(Called(path_));
    throw std::system_error(EAGAIN, std::generic_category(),
                            fmt::format("{}: {} of {} frames arrived, FFmpeg could not write the others (its "
                                        "threads: see ulimit -u; memory)",
                                        Called(path_), whole, frames_));
  }
  if (rename(file_->path.c_str(), path_.c_str()) != 0) FailToWrite(Called(path_), errno);
  file_.reset();
}

}  // namespace ed3r::app
