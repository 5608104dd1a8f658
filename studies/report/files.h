// Files of a report: each is replaced whole or left as it was.
#pragma once

#include <filesystem>
#include <string>

namespace ed3r {

// Throws UserError that names the file when it cannot be written.
void WriteWhole(const std::filesystem::path& file, const std::string& text);

// Makes the folder and those above it where they are missing. Throws UserError when it cannot.
void MakeFolder(const std::filesystem::path& folder);

}  // namespace ed3r
