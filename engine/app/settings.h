// "--set KEY=VALUE" on the command line.
#pragma once

#include <string>
#include <vector>

#include "engine/config/parameters.h"

namespace ed3r::app {

// Applies the settings in order and checks the rules between parameters. Throws UserError.
void ApplySettings(const std::vector<std::string>& settings, Scope scope, Config& config);

}  // namespace ed3r::app
