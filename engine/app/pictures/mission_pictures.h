// Pictures of what the camera saw in timesteps of a mission that was flown again.
#pragma once

#include <string>

#include "engine/mission/mission.h"

namespace ed3r::app {

class MissionPictures {
 public:
  // Builds the mission's scene for the camera and loads its detectors unless the mission itself looked at pixels.
  // Throws UserError for detectors that are none. The task must outlive this.
  explicit MissionPictures(const mission::MissionTask& task);

  // Writes STEM_frames.png and STEM_large.png of timestep k of a flight of the task; returns what to tell: the files,
  // and for a mission of the fast tier that its own confidences were others. Throws UserError when it cannot write.
  std::string Write(const mission::MissionRecord& flown, std::int64_t k, const std::string& stem) const;

 private:
  bool Looked() const { return task_.pixels != nullptr; }  // the mission itself, at pixels

  const mission::MissionTask& task_;
  perception::PixelTier own_;  // where the mission has none
};

}  // namespace ed3r::app
