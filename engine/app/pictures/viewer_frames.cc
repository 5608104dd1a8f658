#include "engine/app/pictures/viewer_frames.h"

#include <openssl/evp.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/render/renderer.h"

namespace ed3r::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr perception::PictureSize kSizes[] = {{320, 180}, {192, 108}, {128, 72}, {96, 54}};
constexpr int kJpegQuality = 78;

std::string Base64(const std::vector<unsigned char>& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // and the zero that OpenSSL writes
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(),
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

std::string AsJpeg(perception::FrameStack frame) {
  const cv::Mat rgb(frame.height_px, frame.width_px, CV_8UC3, frame.rgb.data());
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<unsigned char> bytes;
  ED3R_CHECK(cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality}), "a frame as JPEG");
  return Base64(bytes);
}

}  // namespace

Json ViewerFrames(const mission::MissionTask& task, const mission::MissionRecord& flown) {
  if (task.pixels == nullptr) return nullptr;
  const perception::Renderer renderer(task.pixels->scene, static_cast<int>(flown.site),
                                      task.config.perception, task.config.sensing, task.seed, task.scenario);
  const int middle[] = {task.config.sensing.Frames() / 2};
  Json found;
  for (const perception::PictureSize size : kSizes) {
    std::size_t bytes = 0;
    found = {{"number", middle[0]}, {"width_px", size.width_px}, {"height_px", size.height_px}};
    found["jpeg"] = Json::array();
    for (const mission::TimestepRecord& step : flown.steps) {
      const robot::Pose pose{{step.x_m, step.y_m, step.z_m}, step.yaw_rad, step.tilt_rad};
      found["jpeg"].push_back(
          AsJpeg(renderer.Sense(pose, static_cast<std::uint32_t>(step.k), middle, size).frames));
      bytes += found["jpeg"].back().get_ref<const std::string&>().size();
      if (bytes > kFramesBytes) break;  // too large
    }
    if (bytes <= kFramesBytes) return found;
  }
  found["jpeg"].erase(found["jpeg"].size() - 1);  // a mission of very many timesteps: those that fit
  return found;
}

}  // namespace ed3r::app
