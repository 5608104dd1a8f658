// The one way in and the one way out for whole files.
//
// In: only regular files are opened, whatever a library would do with a FIFO, a device or a folder, and none longer
// than the caller allows. Out: a file is written under a name that nobody can guess beside its place (never through a
// link), flushed to disk and renamed, so that readers see the old file or the new one, also after a crash.
// Errors: UserError, one line that begins with the path. Threads: nothing is shared.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r {

inline constexpr std::uintmax_t kMaxTextBytes = 256u << 20;  // logs, stem maps
inline constexpr std::uintmax_t kMaxModelBytes = 1u << 30;   // networks, pictures

// Why the path is no regular file that can be opened ("No such file or directory", "a FIFO, not a file"), or "".
std::string WhyNoRegularFile(const std::string& path);

// "path: cannot be read: why" as UserError, or the file's whole content.
std::string ReadFile(const std::string& path, std::uintmax_t max_bytes = kMaxTextBytes);

// The same for callers with words of their own: false and why, in place of throwing.
bool TryReadFile(const std::string& path, std::uintmax_t max_bytes, std::string& content, std::string& why);

// A file that appears whole or not at all. Unless committed, the destructor removes what was written.
class AtomicFile {
 public:
  // Refuses a place where something other than a file or a link stands; a link is replaced, never followed.
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(std::string_view bytes);
  void Sync();    // what was written is on the disk, under its hidden name
  void Commit();  // the last call; syncs the file, renames it, syncs its folder
  const std::filesystem::path& path() const { return path_; }

 private:
  void Flush();
  [[noreturn]] void Fail(int error);

  std::filesystem::path path_, temporary_;
  std::string buffer_;
  int descriptor_ = -1;
};

// Files that belong together: whoever looks finds all that were there before, or all new ones, or that some are missing, but
// never files of two sets, also after a crash. Unless committed, nothing is changed; a Commit() that fails may leave some missing.
class FileSet {
 public:
  // Lives as long as the set, which commits it.
  AtomicFile& Add(const std::filesystem::path& path);
  void Add(const std::filesystem::path& path, std::string_view content) { Add(path).Write(content); }
  // The last call; the files appear in the order in which they were added.
  void Commit();

 private:
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

// "where: cannot be written: why", of an errno: std::system_error where the system has failed (a full disk), else UserError.
[[noreturn]] void FailToWrite(const std::string& where, int error);

void WriteFile(const std::filesystem::path& path, std::string_view content);

// UserError where the file that `option` is to write is one of the inputs, by path, link or hard link: the command would
// write over what it reads.
void CheckNoInput(const std::filesystem::path& output, const std::vector<std::string>& inputs,
                  std::string_view option);

// Makes the folder and those above it where they are missing, for files to be written there; removes leftovers.
void MakeFolder(const std::filesystem::path& folder);

}  // namespace ed3r
