// Temporary files and folders: of names that nobody can guess, locked while they are used, and known to core/temporary.h, so that a
// signal that ends the process takes them away; the next command takes away what a killed one left.
//
// Threads: any.
#pragma once

#include <filesystem>
#include <string_view>

namespace ed3r {

inline constexpr std::string_view kTemporaryEnd = ".tmp", kTemporaryFilm = ".mp4", kTemporaryFolder = ".dir";

// A new file in `folder`, of a name that nobody can guess: its descriptor, -1 with errno where there is none. It is locked
// while the descriptor is open, so that RemoveLeftovers can tell it from one whose process is gone.
int MakeTemporaryFile(const std::filesystem::path& folder, std::string_view end, std::filesystem::path& made);

// Removes the temporary files and folders that killed processes left in this folder: those of such names, that
// no process of this machine has open, or that another machine has not touched for a day. Errors are passed over: nothing depends on
// it. Returns how many there were.
int RemoveLeftovers(const std::filesystem::path& folder);

// A folder that is removed with its object, named and locked as such a file is. Those that killed processes left beside it are
// taken away.
class TemporaryFolder {
 public:
  // std::system_error where it cannot be made: the system has failed, not the one who named the place.
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
