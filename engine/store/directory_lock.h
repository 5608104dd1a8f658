// One writer per run directory. The lock is the kernel's (flock on the directory itself): it leaves no file
// behind and ends with the process, however that ends. It holds among the processes of one machine.
#pragma once

#include <optional>
#include <string>

namespace ed3r {

class DirectoryLock {
 public:
  // Nothing when another process (or another object of this one) holds the lock. UserError when the directory
  // cannot be opened.
  static std::optional<DirectoryLock> TryLock(const std::string& dir);
  ~DirectoryLock();
  DirectoryLock(DirectoryLock&& other) noexcept;
  DirectoryLock& operator=(DirectoryLock&&) = delete;

 private:
  explicit DirectoryLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace ed3r
