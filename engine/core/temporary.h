// Files and folders that are to be gone when the process is: those that are known here are removed when a signal ends it at
// once (core/interrupt.h).
//
// Threads: any. Errors: told by return values, as nobody's result depends on it.
#pragma once

#include <filesystem>

namespace ed3r {

// From now on a signal takes it away, a folder with all that is in it.
void RemoveOnSignal(const std::filesystem::path& path);
// It is gone, or has become what shall stay.
void KeepOnSignal(const std::filesystem::path& path);
// For the signal handler.
void RemoveTemporaries();

}  // namespace ed3r
