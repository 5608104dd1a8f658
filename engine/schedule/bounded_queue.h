// A queue of many producers and one consumer that holds a bounded number of items, so that finished missions
// cannot pile up in memory when the disk is slow.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <utility>

namespace ed3r::schedule {

template <class Item>
class BoundedQueue {
 public:
  enum class Result { kItem, kNothingYet, kEnd };

  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  // Waits while the queue is full. False, and the item is dropped, once the queue is closed.
  bool Push(Item item) {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] { return closed_ || items_.size() < capacity_; });
    if (closed_) return false;
    items_.push_back(std::move(item));
    arrived_.notify_one();
    return true;
  }

  // The next item; kNothingYet when none arrives in time; kEnd when the queue is closed and empty.
  Result Pop(Item& item, std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, patience, [&] { return closed_ || !items_.empty(); });
    if (items_.empty()) return closed_ ? Result::kEnd : Result::kNothingYet;
    item = std::move(items_.front());
    items_.pop_front();
    room_.notify_one();
    return Result::kItem;
  }

  void Close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    room_.notify_all();
    arrived_.notify_all();
  }

 private:
  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable room_, arrived_;
  std::deque<Item> items_;
  bool closed_ = false;
};

}  // namespace ed3r::schedule
