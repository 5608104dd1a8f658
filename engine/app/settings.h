// "--set KEY=VALUE" on the command line.
#pragma once

#include <string>
#include <vector>

#include "engine/config/parameters.h"

namespace ed3r::app {

// Refuses a key that is set twice: one of its values would be lost. Throws UserError.
void CheckSetOnce(const std::vector<std::string>& settings);

// Applies the settings, each key once, and checks the rules between parameters. Throws UserError.
void ApplySettings(const std::vector<std::string>& settings, Scope scope, Config& config);

}  // namespace ed3r::app
