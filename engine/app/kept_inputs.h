// What a run keeps besides its missions: the files that it was made from, and the networks that flew.
#pragma once

#include <string>

#include "engine/store/reader.h"

namespace ed3r::app {

// "" where they match their checksums, else the line that says what does not. `dir`: the run, for messages.
std::string DamageOfInputs(store::ResultReader& reader, const std::string& dir);

}  // namespace ed3r::app
