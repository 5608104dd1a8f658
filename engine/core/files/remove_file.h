// The way out for files that a command has written before and does not write now: beside its new files they would be taken
// for theirs.
#pragma once

#include <filesystem>

namespace ed3r {

// Takes away a file or a link, where there is one; a folder of that name is somebody's and stays. UserError, one line that
// begins with the path, where it cannot be taken away.
void RemoveFile(const std::filesystem::path& path);

}  // namespace ed3r
