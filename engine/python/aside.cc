#include "engine/python/aside.h"

#include <chrono>

#include "engine/core/threads.h"

namespace ed3r::python {
namespace {

// How long Ctrl-C waits at most to be heard.
constexpr std::chrono::milliseconds kTick{100};

}  // namespace

void Aside::Keep(const std::function<void()>& heed_or_call) {
  try {
    heed_or_call();
  } catch (...) {
    error_ = std::current_exception();
    stop_ = true;
  }
}

void Aside::Run(const std::function<void()>& work) {
  std::exception_ptr thrown;
  std::thread worker = NewThread([&] {
    try {
      work();
    } catch (...) {
      thrown = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  });
  for (std::unique_lock lock(mutex_); !ended_;) {
    changed_.wait_for(lock, kTick, [this] { return ended_ || call_ != nullptr; });
    const std::function<void()>* const call = call_;
    lock.unlock();
    if (!error_) Keep(call != nullptr ? *call : heed_);
    lock.lock();
    if (call == nullptr) continue;
    call_ = nullptr;
    changed_.notify_all();
  }
  worker.join();
  if (error_) std::rethrow_exception(error_);
  if (thrown) std::rethrow_exception(thrown);
}

void Aside::Call(const std::function<void()>& call) {
  std::unique_lock lock(mutex_);
  call_ = &call;
  changed_.notify_all();
  changed_.wait(lock, [this] { return call_ == nullptr; });
  if (error_) throw NotCalled();
}

}  // namespace ed3r::python
