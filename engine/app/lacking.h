// What a run lacks of its plan.
#pragma once

#include <cstdint>
#include <string>

#include "engine/store/reader.h"

namespace ed3r::app {

// "note: BEFORE 24 of 60 planned missions" where some are not stored, else nothing.
void TellLacking(std::int64_t missions, std::int64_t planned, const std::string& before);
void TellLacking(store::ResultReader& reader, const std::string& before);

}  // namespace ed3r::app
