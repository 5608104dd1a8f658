// An MP4 file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "engine/app/pictures/video_codec.h"

namespace ed3r::app {

class FilmWriter {
 public:
  // Opens it, as H.264 where this machine can, else as MPEG-4; sides must be even. Throws UserError for an ending other
  // than .mp4, a place that cannot be written, and where no codec is found.
  FilmWriter(const std::filesystem::path& path, cv::Size size_px, double frames_per_second);
  ~FilmWriter();
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;

  void Add(const cv::Mat& bgr);  // 8 bits a channel, of the film's size
  // The last call. Throws UserError where it cannot be written, std::exception where the system has failed.
  void Commit();
  int Frames() const { return frames_; }

 private:
  // The film until it is whole, under a name of its own beside its place, so that nothing that stands there is written through.
  struct Temporary {
    Temporary(const std::filesystem::path& film, const std::string& called);
    ~Temporary();
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    void CheckRoom(const std::string& called) const;  // OpenCV does not tell of a full disk
    std::filesystem::path path;
    int descriptor;
  };

  std::filesystem::path path_;
  cv::Size size_px_;
  std::optional<Temporary> file_;
  std::unique_ptr<VideoCodec> codec_;
  int frames_ = 0;
};

}  // namespace ed3r::app
