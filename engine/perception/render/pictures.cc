#include "engine/perception/render/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/check.h"
#include "engine/world/files/picture_file.h"

namespace ed3r::perception {
namespace {

constexpr int kGapPx = 4, kCaptionPx = 16;

// A frame in OpenCV's order of channels, enlarged without smoothing.
cv::Mat Enlarged(const FrameStack& stack, int frame, int scale) {
  ED3R_CHECK(frame >= 0 && frame < stack.frames && scale >= 1, fmt::format("frame {} x {}", frame, scale));
  const std::size_t bytes = static_cast<std::size_t>(stack.width_px) * stack.height_px * 3;
  cv::Mat picture(stack.height_px, stack.width_px, CV_8UC3);
  const std::uint8_t* from = stack.rgb.data() + static_cast<std::size_t>(frame) * bytes;
  for (std::size_t i = 0; i < bytes; i += 3) {
    picture.data[i] = from[i + 2];
    picture.data[i + 1] = from[i + 1];
    picture.data[i + 2] = from[i];
  }
  cv::Mat large;
  cv::resize(picture, large, cv::Size(), scale, scale, cv::INTER_NEAREST);
  return large;
}

}  // namespace

void WriteFrame(const FrameStack& stack, int frame, const std::string& path, int scale) {
  world::WritePicture(Enlarged(stack, frame, scale), path);
}

void WriteContactSheet(const FrameStack& stack, const std::vector<std::string>& captions,
                       const std::string& path, int across, int scale) {
  ED3R_CHECK(stack.frames > 0 && across > 0, "an empty sheet");
  ED3R_CHECK(captions.empty() || static_cast<int>(captions.size()) == stack.frames,
             "a caption for each frame");
  const int caption_px = captions.empty() ? 0 : kCaptionPx;
  const int cell_w = scale * stack.width_px + kGapPx, cell_h = scale * stack.height_px + kGapPx + caption_px;
  const int down = (stack.frames + across - 1) / across;
  cv::Mat sheet(down * cell_h + kGapPx, across * cell_w + kGapPx, CV_8UC3, cv::Scalar(250, 250, 248));
  for (int i = 0; i < stack.frames; ++i) {
    const int x = kGapPx + i % across * cell_w, y = kGapPx + i / across * cell_h;
    Enlarged(stack, i, scale).copyTo(sheet(cv::Rect(x, y, scale * stack.width_px, scale * stack.height_px)));
    if (caption_px > 0)
      cv::putText(sheet, captions[static_cast<std::size_t>(i)],
                  {x, y + scale * stack.height_px + kCaptionPx - 4}, cv::FONT_HERSHEY_SIMPLEX, 0.4,
                  cv::Scalar(48, 44, 40), 1, cv::LINE_AA);
  }
  world::WritePicture(sheet, path);
}

void WriteFramePictures(const Renderer& renderer, const robot::Pose& pose, std::uint32_t timestep,
                        const std::vector<std::string>& captions, const std::string& stem) {
  const SensingFrames sensed = renderer.Sense(pose, timestep);
  const int scale = sensed.frames.width_px < 150 ? 3 : 1;
  WriteContactSheet(sensed.frames, captions, stem + "_frames.png", 6, scale);
  const int middle[] = {sensed.frames.frames / 2};
  WriteFrame(renderer.Sense(pose, timestep, middle, {960, 540}).frames, 0, stem + "_large.png");
}

}  // namespace ed3r::perception
