#include "engine/app/pictures/video_codec.h"

#include <stdlib.h>

#include <opencv2/videoio.hpp>

namespace ed3r::app {
namespace {

class OpenCvCodec : public VideoCodec {
 public:
  bool Open(const std::string& file, double frames_per_second, cv::Size size_px) override {
    file_ = file;
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8",
           0);  // what fails there is told by who looks whether the film is whole
    for (const int codec :
         {cv::VideoWriter::fourcc('a', 'v', 'c', '1'), cv::VideoWriter::fourcc('m', 'p', '4', 'v')})
      if (writer_.open(file, cv::CAP_FFMPEG, codec, frames_per_second, size_px)) return true;
    return false;
  }
  void Write(const cv::Mat& bgr) override { writer_.write(bgr); }
  int Close() override {
    writer_.release();
    cv::VideoCapture reader(file_, cv::CAP_FFMPEG);
    return reader.isOpened() ? static_cast<int>(reader.get(cv::CAP_PROP_FRAME_COUNT)) : 0;
  }

 private:
  std::string file_;
  cv::VideoWriter writer_;
};

}  // namespace
}  // namespace ed3r::app

extern "C" ed3r::app::VideoCodec* Ed3rNewVideoCodec() { return new ed3r::app::OpenCvCodec; }
