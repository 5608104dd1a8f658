// Pictures as files: PNG and JPEG, read with their sides known before anything is decoded, written whole.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace ed3r::world {

struct PictureSides {
  int width_px = 0, height_px = 0;
};

inline constexpr int kMaxPictureSidePx = 20000;
inline constexpr int kMaxPicturePixels = 40'000'000;

// What the header of a PNG or JPEG tells; `name` stands in messages. Throws UserError for other content, for a picture
// that is cut short and for sides beyond the limits.
PictureSides ReadPictureSides(std::string_view bytes, const std::string& name);

struct Picture {
  cv::Mat bgr;       // 8 bits a channel, blue first
  std::string note;  // how more than that, or less, was made so; "" for plain colours
};

// A picture as colours. Grey is red = green = blue; of 16-bit colours the upper 8 bits are taken; what is see-through lies
// over black; both are turned as their camera says. Throws UserError as above, for one that is damaged or cut short, and for
// one channel of 16 bits: a thermal picture or raw counts, which are no colours.
Picture ReadPicture(const std::string& path);

// By the ending of `path`: .png, .jpg or .jpeg. Throws UserError.
void WritePicture(const cv::Mat& picture, const std::string& path);

}  // namespace ed3r::world
