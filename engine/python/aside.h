// Work on a thread of its own, while the calling one stays free for what is its alone: Python's signals and its policies.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>

namespace ed3r::python {

class Aside {
 public:
  // `heed` is called several times a second on the thread that calls Run. What it throws stops the work.
  explicit Aside(std::function<void()> heed) : heed_(std::move(heed)) {}

  // Returns when `work` has ended. Throws what `heed` or a call has thrown, else what `work` has.
  void Run(const std::function<void()>& work);

  // For `work`: runs `call` on the thread that called Run and waits for its end. Throws NotCalled where it has thrown, or where
  // the work is to stop.
  struct NotCalled : std::exception {};
  void Call(const std::function<void()>& call);

  // True once the work is to stop.
  const std::atomic<bool>& stop() const { return stop_; }

 private:
  void Keep(const std::function<void()>& heed_or_call);

  const std::function<void()> heed_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;                           // the work
  const std::function<void()>* call_ = nullptr;  // waited for
  std::exception_ptr error_;                     // of heed or a call
};

}  // namespace ed3r::python
