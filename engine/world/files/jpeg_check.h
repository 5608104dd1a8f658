// Whether a JPEG is whole. OpenCV's reader fills what is missing with grey and says so on stderr alone.
#pragma once

#include <string>
#include <string_view>

namespace ed3r::world {

// Decodes `bytes`, which have passed ReadPictureSides, with libjpeg and throws UserError that begins with `name` for its
// first error or warning: cut short, damaged. Returns how many channels are stored: 1 of grey, 3 of colours, 4 of inks.
int CheckJpeg(std::string_view bytes, const std::string& name);

}  // namespace ed3r::world
