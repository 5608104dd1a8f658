// One writer per run directory, by the kernel's lock (flock on the directory itself): it leaves no file behind and ends with
// the process, however that ends. It holds among the processes of one machine; for directories that several machines
// share see owner_file.h.
#pragma once

#include <optional>
#include <string>

namespace ed3r::store {

class DirectoryLock {
 public:
  struct Attempt;
  // UserError when the directory cannot be opened.
  static Attempt TryLock(const std::string& dir);
  ~DirectoryLock();
  DirectoryLock(DirectoryLock&& other) noexcept;
  DirectoryLock& operator=(DirectoryLock&&) = delete;

 private:
  explicit DirectoryLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

// Held while a command writes its tables and pictures into a folder, so that no two mix theirs there; none where the file
// system has no locks. UserError while another process holds it.
std::optional<DirectoryLock> LockToWrite(const std::string& dir);

struct DirectoryLock::Attempt {
  std::optional<DirectoryLock> lock = {};  // none when another process (or object of this one) holds it
  // False on a file system that has no such locks, or says that it locks and does not.
  bool supported = true;
};

}  // namespace ed3r::store
