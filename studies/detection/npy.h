// Frames in NumPy's file format: NPY 1.0, uint8, frames x height x width x 3, C order.
#pragma once

#include <cstddef>
#include <string>

#include "engine/perception/image.h"

namespace ed3r::detection {

// A file's bytes, held once: a recording may fill the memory.
class NpyFrames {
 public:
  // `name` stands in messages. Throws UserError for another layout, for sides outside 1 .. 20000 pixels, and for a file
  // whose length is not what its header tells.
  NpyFrames(std::string bytes, const std::string& name);

  int frames() const { return frames_; }
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  // Copies of `count` frames from `first` on, all of them in the file.
  perception::FrameStack Some(int first, int count) const;

 private:
  std::size_t FrameBytes() const;

  std::string bytes_;
  std::size_t begin_ = 0;  // of the first frame
  int frames_ = 0, width_px_ = 0, height_px_ = 0;
};

}  // namespace ed3r::detection
