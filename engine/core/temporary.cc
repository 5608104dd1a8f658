#include "engine/core/temporary.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <system_error>

#include "engine/core/check.h"
#include "engine/core/file.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

// A process has a few at a time; one for which there is no room outlives a signal.
constexpr std::size_t kKnown = 64;
constexpr int kDeepest = 16;
std::array<std::atomic<char*>, kKnown> known{};
static_assert(std::atomic<char*>::is_always_lock_free, "a signal handler may not lock");

// "ed3r", the machine, a random number: 8 and 16 hexadecimal digits.
constexpr std::string_view kBegin = ".ed3r-";
constexpr std::size_t kMachineDigits = 8, kRandomDigits = 16;

std::string Prefix() {
  char name[256] = {};
  if (::gethostname(name, sizeof name - 1) != 0) name[0] = '\0';
  std::uint32_t hash = 2166136261u;  // FNV-1a
  for (const char* c = name; *c != '\0'; ++c) hash = (hash ^ static_cast<unsigned char>(*c)) * 16777619u;
  return fmt::format("{}{:08x}-", kBegin, hash);
}

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

// `make` opens what it has made, or -1 with errno.
int MakeLocked(const fs::path& folder, std::string_view end, fs::path& made,
               const std::function<int()>& make) {
  constexpr int kAttempts = 100;
  std::random_device random;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    made = folder / fmt::format("{}{:08x}{:08x}{}", Prefix(), random(), random(), end);
    const int file = make();
    if (file < 0 && errno == EEXIST) continue;
    if (file < 0) return -1;
    // A file system without such locks refuses them to both.
    const bool taken = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    struct stat found = {};
    if (!taken && (::fstat(file, &found) != 0 || found.st_nlink > 0)) {
      RemoveOnSignal(made);
      return file;
    }
    ::close(file);  // taken for a leftover in between
  }
  errno = EEXIST;
  return -1;
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

int MakeTemporaryFile(const fs::path& folder, std::string_view end, fs::path& made) {
  return MakeLocked(folder, end, made, [&made] {
    return ::open(made.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  });
}

bool IsTemporaryName(std::string_view name) {
  const std::size_t digits = kMachineDigits + 1 + kRandomDigits;
  static_assert(kTemporaryEnd.size() == kTemporaryFilm.size() &&
                kTemporaryEnd.size() == kTemporaryFolder.size());
  if (name.size() != kBegin.size() + digits + kTemporaryEnd.size() || !name.starts_with(kBegin) ||
      !(name.ends_with(kTemporaryEnd) || name.ends_with(kTemporaryFilm) || name.ends_with(kTemporaryFolder)))
    return false;
  for (std::size_t i = 0; i < digits; ++i) {
    const char c = name[kBegin.size() + i];
    const bool is_digit = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
    if (i == kMachineDigits ? c != '-' : !is_digit) return false;
  }
  return true;
}

bool IsNamedHere(std::string_view name) { return name.starts_with(Prefix()); }

TemporaryFolder::TemporaryFolder(const fs::path& parent) {
  RemoveLeftovers(parent);
  descriptor_ = MakeLocked(parent, kTemporaryFolder, path_, [this] {
    return ::mkdir(path_.c_str(), 0700) == 0 ? ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
  });
  if (descriptor_ < 0)
    throw UserError(fmt::format("{}: cannot be made: {}", path_.string(), std::strerror(errno)));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  ::close(descriptor_);
  KeepOnSignal(path_);
}

}  // namespace ed3r
