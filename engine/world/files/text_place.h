// Where in a text file something stands, for error messages.
#pragma once

#include <string>

#include "engine/core/files/yaml_reader.h"

namespace ed3r::world {

// "file:line:column", counted from 1; FailAt of yaml_reader.h begins its message with it.
using TextPlace = std::string;

}  // namespace ed3r::world
