// A data set of `ed3r frames`: frames.npy (NPY 1.0, uint8, frames x height x width x 3, C order) and labels.csv.
#pragma once

#include <string>
#include <vector>

#include "engine/perception/image.h"
#include "studies/detection/npy.h"

namespace ed3r::detection {

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
  NpyFrames frames;
  std::vector<FrameLabel> labels;  // one per frame
};

// Whether the folder holds such a data set.
bool IsFrameSet(const std::string& folder);

// Throws UserError that names the file (and line) for files that are missing, of another layout, or disagree, also with the
// hashes in the set's manifest.json where there is one.
FrameSet ReadFrameSet(const std::string& folder);

// What there is to look at: the pictures in a folder (PNG, JPEG, by their endings; sorted by name), or the one file.
struct PictureList {
  std::vector<std::string> paths;
  int passed_over = 0;  // other files in the folder
};

// Throws UserError where nothing lies at the path, and for a folder without pictures.
PictureList ListPictures(const std::string& path);

struct NamedPicture {
  std::string name;  // of the file
  std::string note;  // of ReadPicture
  perception::FrameStack frame;
};

// Throws UserError, one line that begins with the path, where it cannot be read as a picture.
NamedPicture ReadNamedPicture(const std::string& path);

}  // namespace ed3r::detection
