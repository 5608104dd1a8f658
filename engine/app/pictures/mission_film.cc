#include "engine/app/pictures/mission_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "engine/app/pictures/film_picture.h"
#include "engine/app/pictures/mission_clock.h"
#include "engine/perception/render/renderer.h"

namespace ed3r::app {
namespace {

constexpr double kFramesPerSecond = 12.0;
constexpr double kFaster = 4.0;  // mission time to the film's, at least:
constexpr double kLongestFilmS = 60.0;
constexpr int kFramesAtEnd = 24;
constexpr perception::PictureSize kRendered{640, 360};

// The camera's pictures. A hovering robot's view is traced once for all frames of its timestep; in flight each is traced.
class FilmCamera {
 public:
  FilmCamera(const mission::MissionTask& task, const mission::MissionRecord& flown)
      : renderer_(task.pixels != nullptr ? task.pixels->scene
                                         : std::make_shared<const perception::TraceScene>(task.scene),
                  static_cast<int>(flown.site), task.config.perception, task.config.sensing, task.seed,
                  task.scenario),
        frames_(task.config.sensing.Frames()) {}

  // number: of the film's frame; the fire flickers with it.
  cv::Mat Picture(const robot::Pose& pose, std::uint32_t timestep, bool hovers, int number) {
    const int frame = number % frames_;
    if (!hovers) {
      const int one[] = {frame};
      return Enlarged(renderer_.Sense(pose, timestep, one, kRendered).frames, 0);
    }
    if (held_of_ != timestep) {
      std::vector<int> all(static_cast<std::size_t>(frames_));
      std::iota(all.begin(), all.end(), 0);
      held_ = renderer_.Sense(pose, timestep, all, kRendered).frames;
      held_of_ = timestep;
    }
    return Enlarged(held_, frame);
  }

 private:
  static cv::Mat Enlarged(perception::FrameStack& stack, int frame) {
    const std::size_t bytes = static_cast<std::size_t>(stack.width_px) * stack.height_px * 3;
    const cv::Mat rgb(stack.height_px, stack.width_px, CV_8UC3,
                      stack.rgb.data() + static_cast<std::size_t>(frame) * bytes);
    cv::Mat bgr, large;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    cv::resize(bgr, large, kFilmCameraPx, 0, 0, cv::INTER_CUBIC);
    return large;
  }
  static cv::Mat Enlarged(perception::FrameStack&& stack, int frame) { return Enlarged(stack, frame); }

  perception::Renderer renderer_;
  int frames_;
  perception::FrameStack held_;
  std::uint32_t held_of_ = 0;
};

}  // namespace

MissionFilm::MissionFilm(const mission::MissionTask& task, const std::filesystem::path& path)
    : task_(task), path_(path), writer_(path, kFilmSizePx, kFramesPerSecond) {}

// On its way along what was followed, from the end of the move on where the record has it.
robot::Pose MissionFilm::PoseAt(const mission::MissionRecord& flown, std::size_t step, double since_s) const {
  const mission::TimestepRecord& s = flown.steps[step];
  const robot::Pose stored{{s.x_m, s.y_m, s.z_m}, s.yaw_rad, s.tilt_rad};
  const auto found = track_.find(static_cast<std::uint32_t>(s.k));
  if (found == track_.end() || since_s >= MovingS(s)) return stored;
  const std::vector<robot::TraceSample>& samples = found->second;
  const auto next = std::upper_bound(samples.begin(), samples.end(), since_s,
                                     [](double at, const robot::TraceSample& t) { return at < t.time_s; });
  if (next == samples.end()) return stored;
  if (next == samples.begin()) return {next->position_m, next->yaw_rad, s.tilt_rad};
  const robot::TraceSample& before = *(next - 1);
  const double share = (since_s - before.time_s) / (next->time_s - before.time_s);
  const double turn_rad = std::remainder(next->yaw_rad - before.yaw_rad, 2.0 * std::numbers::pi);
  return {before.position_m + share * (next->position_m - before.position_m),
          before.yaw_rad + share * turn_rad, s.tilt_rad};
}

std::string MissionFilm::Write(const mission::MissionRecord& flown, const std::string& title) {
  if (flown.steps.empty()) return fmt::format("{}: no film, as no timestep was flown\n", path_.string());
  const std::vector<double> begins_s = BeginsS(flown);
  const double faster = std::max(kFaster, std::ceil(begins_s.back() / kLongestFilmS));
  const FilmPicture picture(task_, flown, fmt::format("{}, {:g} times as fast", title, faster));
  FilmCamera camera(task_, flown);
  const auto draw = [&](double time_s, int number, bool ended) {
    const std::size_t step = StepAt(begins_s, time_s);
    const double since_s = time_s - begins_s[step];
    const robot::Pose pose = PoseAt(flown, step, since_s);
    const bool hovers = since_s >= MovingS(flown.steps[step]);
    const cv::Mat seen =
        camera.Picture(pose, static_cast<std::uint32_t>(flown.steps[step].k), hovers, number);
    return picture.Draw({time_s, step, pose, ended}, seen);
  };
  const int frames = static_cast<int>(std::ceil(begins_s.back() * kFramesPerSecond / faster));
  for (int i = 0; i < frames; ++i) writer_.Add(draw(i * faster / kFramesPerSecond, i, false));
  for (int i = 0; i < kFramesAtEnd; ++i) writer_.Add(draw(begins_s.back(), frames + i, true));
  writer_.Commit();
  return fmt::format("{}: {} frames, {:.0f} s, {:g} times as fast\n", path_.string(), writer_.Frames(),
                     writer_.Frames() / kFramesPerSecond, faster);
}

}  // namespace ed3r::app
