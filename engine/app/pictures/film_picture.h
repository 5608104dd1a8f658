// One picture of a mission's film: what the camera sees with what is known and decided, the map from above, SCS by time.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "engine/mission/mission.h"

namespace ed3r::app {

inline const cv::Size kFilmSizePx{1280, 600};
inline const cv::Size kFilmCameraPx{800, 450};

struct FilmMoment {
  double time_s = 0.0;
  std::size_t step = 0;  // index of the timestep under way
  robot::Pose pose;
  bool ended = false;
};

class FilmPicture {
 public:
  // Task and record must outlive this. `title` names the mission.
  FilmPicture(const mission::MissionTask& task, const mission::MissionRecord& flown, std::string title);

  // camera: of kFilmCameraPx.
  cv::Mat Draw(const FilmMoment& moment, const cv::Mat& camera) const;

 private:
  cv::Point OnMap(const Eigen::Vector3d& at_m) const;
  cv::Mat BaseMap() const;
  void DrawMap(const FilmMoment& moment, cv::Mat& canvas) const;
  void DrawTold(const FilmMoment& moment, cv::Mat& canvas) const;
  void DrawScores(const FilmMoment& moment, cv::Mat& canvas) const;

  const mission::MissionTask& task_;
  const mission::MissionRecord& flown_;
  std::string title_;
  std::vector<double> begins_s_;
  double px_per_m_;
  cv::Mat map_;
};

}  // namespace ed3r::app
