#include "engine/store/owner_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>
#include <system_error>

#include "engine/core/check.h"
#include "engine/core/threads.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

std::string HostName() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

// What a batch system calls this task; "-" outside of one. A requeued task has the same name.
std::string JobName() {
  for (const char* variable : {"SLURM_JOB_ID", "PBS_JOBID", "JOB_ID", "LSB_JOBID"})
    if (const char* job = std::getenv(variable); job != nullptr && *job != '\0') return job;
  return "-";
}

// How often the batch system has started that task again. Only Slurm tells.
std::string JobStart() {
  const char* restarts = std::getenv("SLURM_RESTART_COUNT");
  return restarts != nullptr && *restarts != '\0' ? restarts : "0";
}

// Where a process number means one process: this boot of this kernel and, as containers count their own, this PID
// namespace. "" where the system does not tell.
std::string ProcessNumbers() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code error;
  const fs::path space = fs::read_symlink("/proc/self/ns/pid", error);
  return boot.empty() || error ? "" : fmt::format("{}/{}", boot, space.string());
}

struct Owner {
  std::string host, job, token;
  pid_t process = 0;
  std::string start, numbers;  // "" in files of before

  std::string Text() const {
    return fmt::format("{} {} {} {} {} {}\n", host, process, job, token, start, numbers);
  }
  std::string Name() const {
    return fmt::format("process {} on {}{}", process, host, job == "-" ? "" : ", job " + job);
  }
};

Owner ThisOwner() {
  std::random_device random;  // only to tell two owners apart
  return {HostName(), JobName(),  fmt::format("{:08x}{:08x}", random(), random()),
          getpid(),   JobStart(), ProcessNumbers()};
}

std::string Content(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return "";
  char bytes[1024];
  const ssize_t got = read(descriptor, bytes, sizeof bytes);
  close(descriptor);
  return got > 0 ? std::string(bytes, static_cast<std::size_t>(got)) : "";
}

std::optional<Owner> Parse(const std::string& text) {
  std::istringstream words(text);
  Owner owner;
  words >> owner.host >> owner.process >> owner.job >> owner.token;
  if (!words || owner.process <= 0) return std::nullopt;
  words >> owner.start >> owner.numbers;
  return owner;
}

// Exclusively: false when the file is there already.
bool Make(const std::string& path, const std::string& text) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0 && errno == EEXIST) return false;
  const bool written = descriptor >= 0 &&
                       write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (written) return true;
  if (descriptor >= 0) unlink(path.c_str());
  throw UserError(fmt::format("{}: cannot be written: {}", path, std::strerror(error)));
}

// Seconds since the file was renewed, by the clock that times both it and a file made now.
double Age_s(const std::string& path, const std::string& beside) {
  struct stat then = {}, now = {};
  Make(beside, "now\n");
  const bool known = stat(path.c_str(), &then) == 0 && stat(beside.c_str(), &now) == 0;
  unlink(beside.c_str());
  return known ? static_cast<double>(now.st_mtime - then.st_mtime) : 0.0;
}

bool IsGone(const Owner& owner, const Owner& self, const std::string& path) {
  const bool same_numbers = owner.host == self.host && owner.numbers == self.numbers && !self.numbers.empty();
  if (same_numbers && kill(owner.process, 0) != 0 && errno == ESRCH) return true;
  // Started again, the job's processes of before are gone. One start may have processes on several machines.
  const bool same_job = owner.job == self.job && self.job != "-";
  if (same_job && owner.start != self.start && !owner.start.empty()) return true;
  return Age_s(path, path + "." + self.token) > static_cast<double>(kOwnerStale.count());
}

// Moves the file of an owner that is gone out of the way. What was moved is looked at: another writer may have been
// quicker, and then gets its file back.
void TakeAway(const std::string& path, const std::string& text, const Owner& self) {
  const std::string aside = path + "." + self.token;
  if (rename(path.c_str(), aside.c_str()) != 0) return;
  // Where even that comes too late, its owner sees that it is gone.
  if (Content(aside) != text) static_cast<void>(link(aside.c_str(), path.c_str()));
  unlink(aside.c_str());
}

}  // namespace

std::unique_ptr<OwnerFile> OwnerFile::TryTake(const std::string& dir, std::string& owner) {
  const std::string path = (fs::path(dir) / kOwnerFile).string();
  const Owner self = ThisOwner();
  for (int attempt = 0; attempt < 3; ++attempt) {
    if (Make(path, self.Text())) return std::unique_ptr<OwnerFile>(new OwnerFile(path, self.Text()));
    const std::string text = Content(path);
    const std::optional<Owner> there = Parse(text);
    // A file without content is being written just now, or was left by a crash: its age decides.
    const bool gone = there ? IsGone(*there, self, path)
                            : Age_s(path, path + "." + self.token) > static_cast<double>(kOwnerStale.count());
    owner = there ? there->Name() : "an unknown process";
    if (!gone) return nullptr;
    TakeAway(path, text, self);
  }
  return nullptr;
}

OwnerFile::OwnerFile(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) {
  try {
    renewer_ = NewThread([this] { Renew(); });
  } catch (...) {  // not renewed, it would keep others out until it is stale
    unlink(path_.c_str());
    throw;
  }
}

OwnerFile::~OwnerFile() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  ends_.notify_all();
  renewer_.join();
  if (Content(path_) == text_) unlink(path_.c_str());
}

void OwnerFile::Renew() {
  std::unique_lock lock(mutex_);
  while (!ends_.wait_for(lock, kOwnerRenewed, [this] { return end_; })) {
    if (Content(path_) != text_) lost_ = true;
    if (!lost_) utimensat(AT_FDCWD, path_.c_str(), nullptr, 0);  // by the server's clock
  }
}

}  // namespace ed3r::store
