// Frames as PNG files, for people.
#pragma once

#include <string>
#include <vector>

#include "engine/perception/image.h"
#include "engine/perception/render/renderer.h"

namespace ed3r::perception {

// One frame, each pixel enlarged to a square of `scale` pixels. Throws UserError when the file cannot be written.
void WriteFrame(const FrameStack& stack, int frame, const std::string& path, int scale = 1);

// All frames on one sheet, `across` in a row, each with the caption of its number (none: no captions).
void WriteContactSheet(const FrameStack& stack, const std::vector<std::string>& captions,
                       const std::string& path, int across = 6, int scale = 3);

// What the camera saw in one timestep: STEM_frames.png (a sheet of the frames that the networks look at, in that size,
// with the captions given, e.g. confidences) and STEM_large.png (one from the middle at 960 x 540).
void WriteFramePictures(const Renderer& renderer, const robot::Pose& pose, std::uint32_t timestep,
                        const std::vector<std::string>& captions, const std::string& stem);

}  // namespace ed3r::perception
