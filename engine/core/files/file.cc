#include "engine/core/files/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/descriptor.h"
#include "engine/core/files/remove_file.h"
#include "engine/core/files/temporary_file.h"
#include "engine/core/temporary.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = 1 << 16;

std::string KindOf(mode_t mode) {
  if (S_ISDIR(mode)) return "Is a directory";
  if (S_ISFIFO(mode)) return "a FIFO, not a file";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device, not a file";
  return "not a file";
}

// Nothing at the end of the file may block: asked before opening, because opening a device may act on it, and once
// more of what was opened. Returns why not, or "".
std::string Refusal(const std::string& path, struct stat& found, int descriptor) {
  const int status = descriptor < 0 ? ::stat(path.c_str(), &found) : ::fstat(descriptor, &found);
  if (status != 0) return std::strerror(errno);
  return S_ISREG(found.st_mode) ? "" : KindOf(found.st_mode);
}

int OpenToRead(const std::string& path) {
  return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
}

// The new name itself must survive a crash. A file system that cannot sync a directory is no reason to fail.
void SyncFolderOf(const fs::path& path) {
  const fs::path parent = path.parent_path();
  const int directory = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return;
  ::fsync(directory);
  ::close(directory);
}

}  // namespace

std::string WhyNoRegularFile(const std::string& path) {
  struct stat found = {};
  if (std::string why = Refusal(path, found, -1); !why.empty()) return why;
  return ::access(path.c_str(), R_OK) == 0 ? "" : std::strerror(errno);
}

bool TryReadFile(const std::string& path, std::uintmax_t max_bytes, std::string& content, std::string& why) {
  struct stat found = {};
  why = Refusal(path, found, -1);
  if (!why.empty()) return false;
  const Descriptor file(OpenToRead(path));
  why = file.number() < 0 ? std::strerror(errno) : Refusal(path, found, file.number());
  if (!why.empty()) return false;
  const auto refuse_length = [&] {
    why = fmt::format("is too long; allowed: at most {} bytes", max_bytes);
    return false;
  };
  if (static_cast<std::uintmax_t>(found.st_size) > max_bytes) return refuse_length();
  content.clear();
  content.reserve(static_cast<std::size_t>(found.st_size));
  std::array<char, kBufferBytes> block;
  while (true) {
    const ssize_t size = ::read(file.number(), block.data(), block.size());
    if (size == 0) return true;
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) {
      why = std::strerror(errno);
      return false;
    }
    content.append(block.data(), static_cast<std::size_t>(size));
    if (content.size() > max_bytes) return refuse_length();  // it grew, or tells no size
  }
}

std::string ReadFile(const std::string& path, std::uintmax_t max_bytes) {
  std::string content, why;
  if (!TryReadFile(path, max_bytes, content, why))
    throw UserError(fmt::format("{}: {}{}", path, why.starts_with("is ") ? "" : "cannot be read: ", why));
  return content;
}

AtomicFile::AtomicFile(const fs::path& path) : path_(path) {
  struct stat found = {};
  if (::lstat(path.c_str(), &found) == 0 && !S_ISREG(found.st_mode) && !S_ISLNK(found.st_mode))
    throw UserError(fmt::format("{}: cannot be written: {}", path.string(), KindOf(found.st_mode)));
  descriptor_ = MakeTemporaryFile(path_.parent_path(), kTemporaryEnd, temporary_);
  if (descriptor_ < 0) Fail(errno);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
  KeepOnSignal(temporary_);
}

void FailToWrite(const std::string& where, int error) {
  // The system has failed, not the one who named the place.
  if (error == ENOSPC || error == EDQUOT || error == EIO)
    throw std::system_error(error, std::generic_category(), fmt::format("{}: cannot be written", where));
  throw UserError(fmt::format("{}: cannot be written: {}", where, std::strerror(error)));
}

void AtomicFile::Fail(int error) { FailToWrite(path_.string(), error); }

void AtomicFile::Write(std::string_view bytes) {
  buffer_ += bytes;
  if (buffer_.size() >= kBufferBytes) Flush();
}

void AtomicFile::Flush() {
  std::string_view left = buffer_;
  while (!left.empty()) {
    const ssize_t written = ::write(descriptor_, left.data(), left.size());
    if (written >= 0)
      left.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      Fail(errno);
  }
  buffer_.clear();
}

void AtomicFile::Sync() {
  ED3R_CHECK(descriptor_ >= 0, path_.string());
  Flush();
  if (::fsync(descriptor_) != 0 && errno != EINVAL) Fail(errno);
}

void AtomicFile::Commit() {
  Sync();
  // Closed by hand: some file systems tell of a failed write only here.
  const int closed = ::close(descriptor_);
  int error = closed != 0 ? errno : 0;
  descriptor_ = -1;
  if (error == 0 && ::rename(temporary_.c_str(), path_.c_str()) != 0) error = errno;
  if (error != 0) ::unlink(temporary_.c_str());
  KeepOnSignal(temporary_);
  if (error != 0) Fail(error);
  SyncFolderOf(path_);
}

AtomicFile& FileSet::Add(const fs::path& path) {
  return *files_.emplace_back(std::make_unique<AtomicFile>(path));
}

void FileSet::Commit() {
  for (const auto& file : files_) file->Sync();  // a full disk is told while the old ones are there
  for (auto file = files_.rbegin(); file != files_.rend(); ++file) RemoveFile((*file)->path());
  for (const auto& file : files_) SyncFolderOf(file->path());
  for (const auto& file : files_) file->Commit();
}

void WriteFile(const fs::path& path, std::string_view content) {
  AtomicFile file(path);
  file.Write(content);
  file.Commit();
}

void CheckNoInput(const fs::path& output, const std::vector<std::string>& inputs, std::string_view option) {
  std::error_code none;  // what is not there is no input
  for (const std::string& input : inputs)
    if (fs::equivalent(output, input, none))
      throw UserError(
          fmt::format("{}: '{}' is what this command reads; allowed: another place, so that '{}' stays",
                      option, output.string(), input));
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  // A link to a folder counts as one, which create_directories does not always see.
  if (error && !fs::is_directory(folder))
    throw UserError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  RemoveLeftovers(folder);
}

}  // namespace ed3r
