// What a film needs of OpenCV's video module, which brings a hundred shared libraries of codecs: it is a library of its own
// (video_codec.cc) that a program loads when a film is asked for, so that no other command pays for it.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace ed3r::app {

class VideoCodec {
 public:
  virtual ~VideoCodec() = default;
  // As H.264 where this machine can, else as MPEG-4; false where it can neither.
  virtual bool Open(const std::string& file, double frames_per_second, cv::Size size_px) = 0;
  virtual void Write(const cv::Mat& bgr) = 0;
  // The last call. How many frames can be read back: OpenCV does not tell of a full disk.
  virtual int Close() = 0;
};

// The library's one function: a new object, the caller's.
inline constexpr const char* kNewVideoCodec = "Ed3rNewVideoCodec";
using NewVideoCodec = VideoCodec*();

}  // namespace ed3r::app
