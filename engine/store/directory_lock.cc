#include "engine/store/directory_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/core/check.h"

namespace ed3r::store {
namespace {

// O_CLOEXEC: a program that this process starts must not keep the lock when the process is gone.
int OpenDirectory(const std::string& dir) {
  const int descriptor = open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) throw UserError(fmt::format("{}: {}", dir, std::strerror(errno)));
  return descriptor;
}

// A lock that is held must keep a second one away.
bool Excludes(const std::string& dir) {
  const int second = OpenDirectory(dir);
  const bool excludes = flock(second, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(second);
  return excludes;
}

}  // namespace

DirectoryLock::Attempt DirectoryLock::TryLock(const std::string& dir) {
  DirectoryLock lock(OpenDirectory(dir));
  if (flock(lock.descriptor_, LOCK_EX | LOCK_NB) == 0) {
    if (!Excludes(dir)) return {std::nullopt, false};
    return {std::move(lock), true};
  }
  return {std::nullopt, errno == EWOULDBLOCK};
}

std::optional<DirectoryLock> LockToWrite(const std::string& dir) {
  DirectoryLock::Attempt attempt = DirectoryLock::TryLock(dir);
  if (!attempt.lock && attempt.supported)
    throw UserError(fmt::format(
        "{}: another ed3r is writing into this folder; give another one, or the same command when it is done",
        dir));
  return std::move(attempt.lock);
}

DirectoryLock::~DirectoryLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

DirectoryLock::DirectoryLock(DirectoryLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

}  // namespace ed3r::store
