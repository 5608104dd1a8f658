#include "engine/core/files/temporary_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <functional>
#include <random>
#include <string>
#include <system_error>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/descriptor.h"
#include "engine/core/temporary.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

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
    std::error_code gone;
    fs::remove(made, gone);  // taken for a leftover in between, by somebody who removes it as well
    ::close(file);
  }
  errno = EEXIST;
  return -1;
}

constexpr std::time_t kForgotten_s = 24 * 60 * 60;

// Where nobody writes it any more; true where it is gone. `here`: it is of this machine, whose locks can be asked.
bool RemoveLeftover(const fs::path& path, bool here) {
  const bool folder = path.extension() == kTemporaryFolder;
  const Descriptor file(
      ::open(path.c_str(), (folder ? O_RDONLY | O_DIRECTORY : O_RDWR | O_NONBLOCK) | O_CLOEXEC | O_NOFOLLOW));
  struct stat found = {};
  if (file.number() < 0 || ::fstat(file.number(), &found) != 0) return false;
  if (folder ? found.st_uid != ::geteuid() : !S_ISREG(found.st_mode)) return false;
  if (!here && std::time(nullptr) - found.st_mtime < kForgotten_s) return false;
  if (::flock(file.number(), LOCK_EX | LOCK_NB) != 0) return false;
  std::error_code error;
  return folder ? fs::remove_all(path, error) > 0 && !error : ::unlink(path.c_str()) == 0;
}

}  // namespace

int MakeTemporaryFile(const fs::path& folder, std::string_view end, fs::path& made) {
  return MakeLocked(folder, end, made, [&made] {
    return ::open(made.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  });
}

TemporaryFolder::TemporaryFolder(const fs::path& parent) {
  RemoveLeftovers(parent);
  descriptor_ = MakeLocked(parent, kTemporaryFolder, path_, [this] {
    if (::mkdir(path_.c_str(), 0700) != 0) return -1;
    const int folder = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0 && errno == ENOENT) errno = EEXIST;  // taken for a leftover in between: another name
    return folder;
  });
  if (descriptor_ < 0)
    throw std::system_error(errno, std::generic_category(),
                            fmt::format("{}: cannot be made", path_.string()));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  ::close(descriptor_);
  KeepOnSignal(path_);
}

int RemoveLeftovers(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (IsTemporaryName(entry->path().filename().string())) found.push_back(entry->path());
  int removed = 0;
  for (const fs::path& path : found)
    if (RemoveLeftover(path, IsNamedHere(path.filename().string()))) ++removed;
  return removed;
}

}  // namespace ed3r
