// An MP4 file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "engine/app/video_codec.h"

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
  void Commit();                 // the last call. Throws UserError where not all frames can be read back
  int Frames() const { return frames_; }

 private:
  std::filesystem::path path_, temporary_;
  cv::Size size_px_;
  std::unique_ptr<VideoCodec> codec_;
  int frames_ = 0;
};

}  // namespace ed3r::app
