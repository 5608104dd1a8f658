// Pictures as files: PNG and JPEG, read with their sides known before anything is decoded, written whole.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace ed3r {

struct PictureSides {
  int width_px = 0, height_px = 0;
};

inline constexpr int kMaxPictureSidePx = 20000;
inline constexpr int kMaxPicturePixels = 40'000'000;

// What the header of a PNG or JPEG tells; `name` stands in messages. Throws UserError for other content, for a picture
// that is cut short and for sides beyond the limits.
PictureSides ReadPictureSides(std::string_view bytes, const std::string& name);

// The picture with 8 bits a channel, blue first. Throws UserError as above, and where it cannot be decoded.
cv::Mat ReadPicture(const std::string& path);

// By the ending of `path`: .png, .jpg or .jpeg. Throws UserError.
void WritePicture(const cv::Mat& picture, const std::string& path);

}  // namespace ed3r
