// A mission that was flown again as a film, for `ed3r replay --video`.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/app/pictures/film_writer.h"
#include "engine/mission/mission.h"

namespace ed3r::app {

// Follows the flight as a TraceSink, then draws it: on the left what the camera sees, with time, timestep, SCS, battery,
// command and who looks; on the right the map. Four times as fast as the mission, or faster, so that the
// film lasts no longer than about a minute.
class MissionFilm : public robot::TraceSink {
 public:
  // Opens the film, so that what cannot be written is told before anything is flown: throws UserError as FilmWriter.
  // The task must outlive this.
  MissionFilm(const mission::MissionTask& task, const std::filesystem::path& path);

  void Record(const robot::TraceSample& sample) override { track_[sample.timestep].push_back(sample); }

  // Writes the film of the flight that was followed; returns what to tell. Throws UserError where it cannot.
  std::string Write(const mission::MissionRecord& flown, const std::string& title);

 private:
  robot::Pose PoseAt(const mission::MissionRecord& flown, std::size_t step, double since_s) const;

  const mission::MissionTask& task_;
  std::filesystem::path path_;
  FilmWriter writer_;
  std::map<std::uint32_t, std::vector<robot::TraceSample>> track_;
};

}  // namespace ed3r::app
