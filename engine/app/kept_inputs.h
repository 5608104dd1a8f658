// What a run keeps besides its missions: the files that it was made from, the networks that flew, the views for SQL.
#pragma once

#include <string>

#include "engine/store/reader.h"

namespace ed3r::app {

// "" where they match their checksums, else the line that says what does not. `dir`: the run, for messages.
std::string DamageBesideMissions(store::ResultReader& reader, const std::string& dir);

}  // namespace ed3r::app
