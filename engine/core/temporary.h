// Files and folders that are to be gone when the process is: those that are known here are removed when a signal ends it at
// once (core/interrupt.h).
//
// Threads: any. Errors: told by return values, as nobody's result depends on it.
#pragma once

#include <filesystem>
#include <string_view>

namespace ed3r {

inline constexpr std::string_view kTemporaryEnd = ".tmp", kTemporaryFilm = ".mp4", kTemporaryFolder = ".dir";

// From now on a signal takes it away, a folder with all that is in it.
void RemoveOnSignal(const std::filesystem::path& path);
// It is gone, or has become what shall stay.
void KeepOnSignal(const std::filesystem::path& path);
// For the signal handler.
void RemoveTemporaries();

// A new file in `folder`, of a name that nobody can guess: its descriptor, -1 with errno where there is none. It is locked
// while the descriptor is open, so that RemoveLeftovers (core/file.h) can tell it from one whose process is gone, and known
// here.
int MakeTemporaryFile(const std::filesystem::path& folder, std::string_view end, std::filesystem::path& made);
bool IsTemporaryName(std::string_view name);
// Of this machine, whose locks can be asked.
bool IsNamedHere(std::string_view name);

// A folder that is removed with its object, named and locked as such a file is. Those that killed processes left beside it are
// taken away.
class TemporaryFolder {
 public:
  // UserError where it cannot be made.
  explicit TemporaryFolder(const std::filesystem::path& parent);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace ed3r
