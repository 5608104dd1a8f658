#include "engine/app/pictures/film_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "engine/app/pictures/mission_clock.h"
#include "engine/core/check.h"
#include "engine/world/map_relief.h"

namespace ed3r::app {
namespace {

const cv::Scalar kPaper(28, 24, 20), kInk(245, 243, 240), kFaint(175, 168, 160), kGood(130, 210, 110),
    kBad(90, 140, 250), kPath(255, 255, 255), kRobot(0, 94, 213), kFire(29, 96, 242), kStation(40, 30, 24);
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
const cv::Rect kMap(800, 0, 480, 450), kTold(0, 450, 800, 150), kScores(872, 476, 384, 92);

// Over a dark rim, so that it is read on any ground.
void Text(cv::Mat& canvas, const std::string& text, cv::Point at, double size,
          const cv::Scalar& colour = kInk) {
  cv::putText(canvas, text, at, kFont, size, kPaper, 4, cv::LINE_AA);
  cv::putText(canvas, text, at, kFont, size, colour, 1, cv::LINE_AA);
}

std::string PartText(const mission::TimestepRecord& step, double since_s) {
  for (const auto& [name, seconds] :
       {std::pair{"flying", MovingS(step)}, std::pair{"sensing", step.sensing_s},
        std::pair{"computing", step.computing_s}}) {
    if (since_s < seconds) return name;
    since_s -= seconds;
  }
  return "transmitting";
}

std::string CommandText(const mission::TimestepRecord& step) {
  const auto along = [](double m, const char* there, const char* back) {
    return fmt::format("{:.1f} m {}", std::abs(m), m < 0 ? back : there);
  };
  const double degrees = 180.0 / std::numbers::pi;
  return fmt::format("{}: {}, {}, {}; turn {:.0f} deg {}, camera {:.0f} deg down{}",
                     NameOf(static_cast<agents::MotionRule>(step.motion_rule)),
                     along(step.command_dx_m, "east", "west"), along(step.command_dy_m, "north", "south"),
                     along(step.command_dz_m, "up", "down"), std::abs(step.command_turn_rad) * degrees,
                     step.command_turn_rad < 0 ? "right" : "left", step.command_tilt_rad * degrees,
                     step.halted != 0 ? "; halted by an obstacle" : "");
}

std::string LookText(agents::Execution execution) {
  switch (execution) {
    case agents::Execution::kOffload:
      return "Full model, offloaded";
    case agents::Execution::kFull:
      return "Full model, on board";
    case agents::Execution::kQuantized:
      return "Quantized model, on board";
  }
  return "";
}

std::string OutcomeText(std::int64_t outcome) {
  switch (static_cast<mission::Outcome>(outcome)) {
    case mission::Outcome::kSuccess:
      return "SUCCESS";
    case mission::Outcome::kFalsePositive:
      return "FALSE ALARM";
    case mission::Outcome::kBatteryDepleted:
      return "BATTERY EMPTY";
  }
  return "";
}

}  // namespace

FilmPicture::FilmPicture(const mission::MissionTask& task, const mission::MissionRecord& flown,
                         std::string title)
    : task_(task),
      flown_(flown),
      title_(std::move(title)),
      begins_s_(BeginsS(flown)),
      px_per_m_(std::min(kMap.width / task.scene.SizeM().x(), kMap.height / task.scene.SizeM().y())),
      map_(BaseMap()) {}

cv::Point FilmPicture::OnMap(const Eigen::Vector3d& at_m) const {
  const Eigen::Vector3d& size_m = task_.scene.SizeM();
  const double left = 0.5 * (kMap.width - px_per_m_ * size_m.x());
  const double top = 0.5 * (kMap.height - px_per_m_ * size_m.y());
  return {static_cast<int>(std::lround(left + px_per_m_ * at_m.x())),
          static_cast<int>(std::lround(top + px_per_m_ * (size_m.y() - at_m.y())))};
}

cv::Mat FilmPicture::BaseMap() const {
  const world::Scene& scene = task_.scene;
  cv::Mat map(kMap.size(), CV_8UC3, kPaper);
  const cv::Point corner = OnMap({0.0, scene.SizeM().y(), 0.0});
  const cv::Point opposite = OnMap({scene.SizeM().x(), 0.0, 0.0});
  const auto& heights = scene.Ground().height_m;
  const double highest_m =
      std::max(1.0, static_cast<double>(*std::max_element(heights.begin(), heights.end())));
  const cv::Rect ground(corner, opposite);
  world::DrawRelief(scene.Ground(), ground.size(), highest_m).copyTo(map(ground));
  cv::Mat trees = map.clone();
  for (const world::Tree& tree : scene.Trees())
    cv::circle(trees, OnMap({tree.x_m, tree.y_m, 0.0}),
               std::max(1, static_cast<int>(std::lround(tree.crown_radius_m * px_per_m_))),
               cv::Scalar(58, 96, 62), cv::FILLED, cv::LINE_AA);
  cv::addWeighted(trees, 0.7, map, 0.3, 0.0, map);
  for (const world::FireSite& site : scene.Sites())
    cv::circle(map, OnMap(site.base_m), 3, kFaint, 1, cv::LINE_AA);
  const world::BaseStation& station = scene.BaseStations()[static_cast<std::size_t>(flown_.base_station)];
  const cv::Point mast = OnMap(station.antenna_m);
  cv::rectangle(map, mast - cv::Point(5, 5), mast + cv::Point(5, 5), kInk, cv::FILLED);
  cv::rectangle(map, mast - cv::Point(3, 3), mast + cv::Point(3, 3), kStation, cv::FILLED);
  const cv::Point fire = OnMap(scene.Sites()[static_cast<std::size_t>(flown_.site)].base_m);
  cv::circle(map, fire, 9, cv::Scalar(92, 212, 255), cv::FILLED, cv::LINE_AA);
  cv::circle(map, fire, 7, kFire, cv::FILLED, cv::LINE_AA);
  return map;
}

void FilmPicture::DrawMap(const FilmMoment& moment, cv::Mat& canvas) const {
  cv::Mat map = canvas(kMap);
  map_.copyTo(map);
  const cv::Point robot = OnMap(moment.pose.position_m);
  cv::Point from = OnMap({flown_.start_x_m, flown_.start_y_m, flown_.start_z_m});
  for (std::size_t i = 0; i < moment.step; ++i) {
    const mission::TimestepRecord& step = flown_.steps[i];
    const cv::Point to = OnMap({step.x_m, step.y_m, step.z_m});
    cv::line(map, from, to, kPath, 2, cv::LINE_AA);
    from = to;
  }
  cv::line(map, from, robot, kPath, 2, cv::LINE_AA);
  // What the camera looks at: its field of view, 60 m far.
  const double half_rad = 0.5 * task_.config.sensing.camera_hfov_deg * std::numbers::pi / 180.0;
  for (const double side : {-half_rad, half_rad}) {
    const double angle = moment.pose.yaw_rad + side;
    cv::line(map, robot,
             OnMap(moment.pose.position_m + 60.0 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)),
             cv::Scalar(80, 212, 255), 1, cv::LINE_AA);
  }
  cv::circle(map, robot, 6, kInk, cv::FILLED, cv::LINE_AA);
  cv::circle(map, robot, 4, kRobot, cv::FILLED, cv::LINE_AA);
  Text(map, "from above, north is up", {10, kMap.height - 12}, 0.45, kFaint);
}

void FilmPicture::DrawTold(const FilmMoment& moment, cv::Mat& canvas) const {
  const mission::TimestepRecord& step = flown_.steps[moment.step];
  const double since_s = moment.time_s - begins_s_[moment.step];
  const std::string part = moment.ended ? "ended" : PartText(step, since_s);
  Text(canvas,
       fmt::format("{:.1f} s   timestep {} of {}   {}", moment.time_s, moment.step + 1, flown_.steps.size(),
                   part),
       {16, 30}, 0.62);
  if (task_.pixels == nullptr)
    Text(canvas, "pictures for this film: the mission's confidences came from geometry",
         {16, kFilmCameraPx.height - 12}, 0.45, kFaint);
  // What is known: of the last timestep that ended.
  const std::size_t known = moment.ended ? moment.step + 1 : moment.step;
  const double full_j = flown_.battery_left_j + flown_.total_j;
  const double battery_j = known == 0 ? full_j : flown_.steps[known - 1].battery_j;
  const double eta = task_.config.agents.eta_min;
  const double scs = known == 0 ? 0.0 : flown_.steps[known - 1].scs;
  Text(canvas, title_, {16, kTold.y + 26}, 0.5, kFaint);
  Text(canvas,
       known == 0 ? fmt::format("SCS -   threshold {:.0f} %", 100 * eta)
                  : fmt::format("SCS {:.1f} %   threshold {:.0f} %", 100 * scs, 100 * eta),
       {16, kTold.y + 56}, 0.7, known > 0 && scs >= eta ? kGood : kInk);
  Text(canvas, fmt::format("battery {:.1f} %", 100 * battery_j / full_j), {420, kTold.y + 56}, 0.7);
  Text(canvas, CommandText(step), {16, kTold.y + 86}, 0.5);
  if (moment.ended || since_s >= MovingS(step))
    Text(canvas,
         fmt::format("{}; {:.1f} Mbit/s to the remote controller",
                     LookText(static_cast<agents::Execution>(step.execution)), step.rate_bps / 1e6),
         {16, kTold.y + 112}, 0.5);
  if (moment.ended)
    Text(canvas, OutcomeText(flown_.outcome), {16, kTold.y + 140}, 0.7,
         flown_.outcome == static_cast<std::int64_t>(mission::Outcome::kSuccess) ? kGood : kBad);
}

void FilmPicture::DrawScores(const FilmMoment& moment, cv::Mat& canvas) const {
  const double end_s = begins_s_.back();
  const auto at = [&](double time_s, double scs) {
    return cv::Point(kScores.x + static_cast<int>(std::lround(kScores.width * time_s / end_s)),
                     kScores.y + static_cast<int>(std::lround(kScores.height * (1.0 - scs))));
  };
  Text(canvas, "SCS, %", {kScores.x - 66, kScores.y + 16}, 0.45, kFaint);
  cv::line(canvas, at(0, 0), at(end_s, 0), kFaint, 1);
  const double eta = task_.config.agents.eta_min;
  cv::line(canvas, at(0, eta), at(end_s, eta), kBad, 1, cv::LINE_AA);
  const std::size_t known = moment.ended ? moment.step + 1 : moment.step;
  for (std::size_t i = 0; i < known; ++i) {
    const double scs = flown_.steps[i].scs;
    const cv::Scalar& colour = scs >= eta ? kGood : kFaint;
    cv::line(canvas, at(begins_s_[i + 1], 0), at(begins_s_[i + 1], scs), colour, 1, cv::LINE_AA);
    cv::circle(canvas, at(begins_s_[i + 1], scs), 4, colour, cv::FILLED, cv::LINE_AA);
  }
  cv::line(canvas, at(moment.time_s, 0), at(moment.time_s, 1), kInk, 1, cv::LINE_AA);
  Text(canvas, fmt::format("0 to {:.1f} min", end_s / 60.0), {kScores.x, kScores.y + kScores.height + 20},
       0.45, kFaint);
}

cv::Mat FilmPicture::Draw(const FilmMoment& moment, const cv::Mat& camera) const {
  ED3R_CHECK(camera.size() == kFilmCameraPx, "the camera's picture");
  cv::Mat canvas(kFilmSizePx, CV_8UC3, kPaper);
  camera.copyTo(canvas(cv::Rect({0, 0}, kFilmCameraPx)));
  DrawMap(moment, canvas);
  DrawTold(moment, canvas);
  DrawScores(moment, canvas);
  return canvas;
}

}  // namespace ed3r::app
