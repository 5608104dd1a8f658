// One writer per run directory on a file system that several machines share, where no lock of a kernel can be trusted: a
// file RUN/results.owner that names the writer, made exclusively (atomic on NFS too) and removed at the end.
//
// A writer that was killed leaves it behind. The next one takes over when it can know that the first is gone: the same
// machine (and container) has no such process any more, the batch system has started the same job again (Slurm counts
// that), or the file has not been renewed for kOwnerStale (a thread renews it while the writer lives; ages are told by the
// clock of the file server).
//
// Should two writers ever meet in spite of this, the results stay right: a mission is a pure function of its number, and
// what they damage in the file is found by its checksums and refused.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace ed3r::store {

inline constexpr char kOwnerFile[] = "results.owner";
inline constexpr std::chrono::seconds kOwnerRenewed{15};
inline constexpr std::chrono::seconds kOwnerStale{120};

class OwnerFile {
 public:
  // Null when a writer that may be alive owns the directory; `owner` then says who ("process 12 on node3, job 4711").
  // UserError when the file cannot be made.
  static std::unique_ptr<OwnerFile> TryTake(const std::string& dir, std::string& owner);
  ~OwnerFile();
  OwnerFile(const OwnerFile&) = delete;
  OwnerFile& operator=(const OwnerFile&) = delete;

  // True once another writer has taken over: this one must not write any more.
  bool Lost() const { return lost_.load(); }

 private:
  OwnerFile(std::string path, std::string text);
  void Renew();

  const std::string path_, text_;
  std::atomic<bool> lost_{false};
  std::mutex mutex_;
  std::condition_variable ends_;
  bool end_ = false;
  std::thread renewer_;
};

}  // namespace ed3r::store
