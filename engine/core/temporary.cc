#include "engine/core/temporary.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace ed3r {
namespace {

namespace fs = std::filesystem;

// A process has a few at a time; one for which there is no room outlives a signal.
constexpr std::size_t kKnown = 64;
constexpr int kDeepest = 16;
std::array<std::atomic<char*>, kKnown> known{};
static_assert(std::atomic<char*>::is_always_lock_free, "a signal handler may not lock");

// By system calls alone, as a signal handler must.
void RemoveTree(int parent, const char* name, int deepest) {
  if (::unlinkat(parent, name, 0) == 0 || errno != EISDIR || deepest == 0) return;
  const int folder = ::openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return;
  alignas(dirent64) char entries[2048];
  for (long size = 0; (size = ::syscall(SYS_getdents64, folder, entries, sizeof entries)) > 0;)
    for (long at = 0; at < size;) {
      const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
      at += entry->d_reclen;
      if (std::strcmp(entry->d_name, ".") != 0 && std::strcmp(entry->d_name, "..") != 0)
        RemoveTree(folder, entry->d_name, deepest - 1);
    }
  ::close(folder);
  ::unlinkat(parent, name, AT_REMOVEDIR);
}

}  // namespace

void RemoveOnSignal(const fs::path& path) {
  char* const name = ::strdup(path.c_str());
  for (std::atomic<char*>& slot : known)
    if (char* none = nullptr; name != nullptr && slot.compare_exchange_strong(none, name)) return;
  ::free(name);
}

void KeepOnSignal(const fs::path& path) {
  for (std::atomic<char*>& slot : known) {
    // Taken out to be looked at, so that it cannot go meanwhile.
    char* const name = slot.exchange(nullptr);
    if (name == nullptr) continue;
    if (path == name) return ::free(name);
    if (char* none = nullptr; !slot.compare_exchange_strong(none, name)) {
      RemoveOnSignal(name);
      ::free(name);
    }
  }
}

void RemoveTemporaries() {
  for (std::atomic<char*>& slot : known)
    if (const char* const name = slot.exchange(nullptr)) RemoveTree(AT_FDCWD, name, kDeepest);
}

}  // namespace ed3r
