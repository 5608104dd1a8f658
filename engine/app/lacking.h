// What a run lacks of its plan.
#pragma once

#include <cstdint>
#include <string>

#include "engine/store/reader.h"

namespace ed3r::app {

// "note: BEFORE 24 of 60 planned missions" where that many of the run are fewer than planned, else nothing.
void TellLacking(const store::ResultReader& reader, std::int64_t missions, const std::string& before);

}  // namespace ed3r::app
