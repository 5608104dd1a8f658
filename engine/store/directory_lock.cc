#include "engine/store/directory_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/core/check.h"

namespace ed3r {

std::optional<DirectoryLock> DirectoryLock::TryLock(const std::string& dir) {
  // O_CLOEXEC: a program that this process starts must not keep the lock when the process is gone.
  const int descriptor = open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) throw UserError(fmt::format("{}: {}", dir, std::strerror(errno)));
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return DirectoryLock(descriptor);
  const int error = errno;
  close(descriptor);
  if (error == EWOULDBLOCK) return std::nullopt;
  throw UserError(fmt::format("{}: cannot be locked: {}", dir, std::strerror(error)));
}

DirectoryLock::~DirectoryLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

DirectoryLock::DirectoryLock(DirectoryLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

}  // namespace ed3r
