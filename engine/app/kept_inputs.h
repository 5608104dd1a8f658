// What a run keeps besides its missions: the files that it was made from, the networks that flew, the views for SQL.
#pragma once

#include <string>
#include <vector>

#include "engine/store/reader.h"

namespace ed3r::app {

// A line for each kind that does not match its checksums. `dir`: the run, for messages.
std::vector<std::string> DamageBesideMissions(store::ResultReader& reader, const std::string& dir);

}  // namespace ed3r::app
