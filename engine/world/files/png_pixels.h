// The pixels of PNG files, by libpng itself: OpenCV prints libpng's errors and warnings and drops what a picture says of its
// own transparency.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace ed3r::world {

struct PngPixels {
  cv::Mat bgra;               // 8 bits a channel, blue first
  bool sixteen_bits = false;  // of which the upper eight are here
  bool grey = false;
  int orientation = 1;  // of the camera, by its eXIf chunk (exif_orientation.h); not applied here
};

// `bytes` have passed ReadPictureSides; `name` begins messages. Throws UserError for a file that is damaged or cut short.
PngPixels DecodePng(std::string_view bytes, const std::string& name);

}  // namespace ed3r::world
