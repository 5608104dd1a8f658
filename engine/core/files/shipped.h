// Where the files that ship with the program are: sweeps with their worlds, plotting scripts, the report's page.
#pragma once

#include <filesystem>
#include <string>

namespace ed3r {

// Where the running program's file is.
std::filesystem::path ProgramFolder();

// The folder `name`, in this order: what the environment's `variable` says, where it is set and not empty;
// share/ed3r/`name` beside the folder that the program runs from (an installed tree, wherever it was moved to);
// `source`, of the tree that the program was built from. It need not exist.
std::filesystem::path ShippedFolder(const char* variable, const std::string& name, const std::string& source);

// As ShippedFolder, for the shipped sweeps: ED3R_SWEEPS, share/ed3r/sweeps, sweeps/ of the source tree.
std::filesystem::path ShippedSweeps();

}  // namespace ed3r
