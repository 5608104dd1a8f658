// Frames in NumPy's file format: NPY 1.0, uint8, frames x height x width x 3, C order.
#pragma once

#include <string>
#include <string_view>

#include "engine/perception/image.h"

namespace ed3r::detection {

// `name` stands in messages. Throws UserError for another layout, for sides outside 1 .. 20000 pixels, and for a file
// whose length is not what its header tells.
perception::FrameStack ParseNpy(std::string_view bytes, const std::string& name);

}  // namespace ed3r::detection
