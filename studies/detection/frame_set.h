// A data set of `ed3r frames`: frames.npy (NPY 1.0, uint8, frames x height x width x 3, C order) and labels.csv.
#pragma once

#include <string>
#include <vector>

#include "engine/perception/image.h"

namespace ed3r {

// The renderer's truth about one frame.
struct FrameLabel {
  std::string world;
  int view = 0;
  double distance_m = 0.0;  // to the fire
  double fire_px = 0.0;
  double smoke_px = 0.0;
  double occluded = 0.0;  // share of fire and smoke in the frustum that something hides
  bool positive = false;  // fire or smoke in view (R16)
};

struct FrameSet {
  FrameStack frames;
  std::vector<FrameLabel> labels;  // one per frame
};

// Whether the folder holds such a data set.
bool IsFrameSet(const std::string& folder);

// Throws UserError that names the file (and line) for files that are missing, of another layout, or disagree.
FrameSet ReadFrameSet(const std::string& folder);

// The pictures in a folder (PNG, JPEG; sorted by name), or the one picture at the path. Throws UserError where there
// are none or one cannot be read.
struct NamedPicture {
  std::string name;
  FrameStack frame;
};
std::vector<NamedPicture> ReadPictures(const std::string& path);

}  // namespace ed3r
