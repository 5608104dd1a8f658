// How a camera was held, from EXIF (CIPA DC-008, tag 0x0112), and a picture turned upright by it.
// Threads: free functions without state.
#pragma once

#include <opencv2/core.hpp>
#include <string_view>

namespace ed3r::world {

// 1 .. 8 of an EXIF block (TIFF header first, perhaps after "Exif" and two zeros); 1, upright, where it does not say.
int ExifOrientation(std::string_view exif);

// `picture` as it is to be seen. Orientations beyond 1 .. 8 turn nothing.
cv::Mat Turned(const cv::Mat& picture, int orientation);

}  // namespace ed3r::world
