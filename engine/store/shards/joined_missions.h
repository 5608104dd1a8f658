// Missions of many stores side by side in plan order, however they were divided. Threads read them ahead and compare each with
// its checksums, so that whoever takes them has only to take them.
//
// Threads: one object is used by one thread; those that read ahead are its own.
// Errors: Next() throws what a reading thread met, when it comes there or a few missions before: UserError for a damaged one.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/checksums.h"
#include "engine/store/reader.h"

namespace ed3r::store {

// A mission that has been compared with its checksums.
struct ComparedMission {
  std::int64_t run = 0, mission = 0;  // its key in the tables
  sweep::RunId id;
  mission::MissionRecord record;
  Checksums checksums;  // over the columns of its own file; "" in files of format 1
  bool keeps_timesteps = true;
  std::int64_t session = 0;
  double wall_s = 0;  // NaN where it is not known
};

class JoinedMissions {
 public:
  // Each store is read as of the moment of this call. `readers` must outlive it; they remain free for other questions.
  // Where the machine gives fewer threads, those read; std::system_error where it gives none.
  JoinedMissions(const std::vector<std::unique_ptr<ResultReader>>& readers, int threads);
  ~JoinedMissions();
  JoinedMissions(const JoinedMissions&) = delete;
  JoinedMissions& operator=(const JoinedMissions&) = delete;

  // The next mission in plan order, one after another where several stores have it, in the readers' order; null at the
  // end. Good until the next call.
  const ComparedMission* Next();
  // Which of the readers it is from.
  std::size_t source() const { return present_; }

 private:
  class Source;
  // The key of a source's next mission, and the source.
  using Head = std::pair<std::pair<std::int64_t, std::int64_t>, std::size_t>;

  void ReadAhead(std::size_t thread);
  Source* Hungriest(std::size_t thread, bool& any_left);
  bool Advance(std::size_t source);
  void PushHead(std::size_t source);

  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<Head> heads_;  // a heap
  std::size_t present_ = 0;
  bool begun_ = false;
  std::mutex mutex_;
  std::condition_variable filled_, room_;
  bool stop_ = false;
  std::vector<std::thread> threads_;  // last: they use all of the above
};

}  // namespace ed3r::store
