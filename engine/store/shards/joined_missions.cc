#include "engine/store/shards/joined_missions.h"

#include <algorithm>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <system_error>

#include "engine/core/threads.h"
#include "engine/store/records.h"
#include "engine/store/schema.h"

namespace ed3r::store {
namespace {

// Read ahead from each store: two batches of about this size. A hundred stores then take some tens of megabytes, page caches
// included.
constexpr std::size_t kBatchBytes = 64 * 1024;
constexpr std::size_t kBatchesAhead = 2;
// Three cursors go through each file once, from its begin to its end.
constexpr int kCacheKib = 512;

std::size_t BytesOf(const mission::MissionRecord& record) {
  return sizeof record + record.steps.size() * sizeof(mission::TimestepRecord);
}

}  // namespace

// One store. What its reading thread shares with the taker is guarded by the mutex of JoinedMissions.
class JoinedMissions::Source {
 public:
  explicit Source(const ResultReader& reader)
      : database_((std::filesystem::path(reader.dir()) / kResultsFile).string(),
                  Connection::Access::kReadOnly),
        moment_(database_, Transaction::Kind::kRead),
        cursor_(database_, reader.Layout(), "", Steps::kLoad) {
    database_.Execute(fmt::format("PRAGMA cache_size = -{}", kCacheKib));
    // The moment begins with the first look. Keys are the reader's while the plan is.
    if (database_.Text("SELECT value FROM recipe WHERE key = 'plan'") != reader.StoredRecipe().plan_text)
      throw UserError(
          fmt::format("{}: its plan has grown meanwhile; give the same command again", reader.dir()));
  }

  // For the reading thread.
  std::vector<ComparedMission> ReadBatch(bool& ended) {
    std::vector<ComparedMission> batch;
    for (std::size_t bytes = 0; bytes < kBatchBytes; bytes += BytesOf(batch.back().record)) {
      if (!cursor_.Next()) {
        ended = true;
        break;
      }
      const sweep::RunId id = cursor_.Checked();
      batch.push_back({cursor_.run(),
                       cursor_.mission(),
                       id,
                       cursor_.record(),
                       {cursor_.checksum(), cursor_.steps_checksum()},
                       cursor_.KeepsTimesteps(),
                       cursor_.session(),
                       cursor_.wall_s()});
    }
    return batch;
  }

  // Shared.
  std::deque<std::vector<ComparedMission>> ahead;
  bool ended = false;  // nothing will come after `ahead`
  std::exception_ptr error;

  // The taker's.
  std::vector<ComparedMission> present;
  std::size_t at = 0;

 private:
  Connection database_;
  Transaction moment_;
  MissionCursor cursor_;
};

JoinedMissions::JoinedMissions(const std::vector<std::unique_ptr<ResultReader>>& readers, int threads) {
  for (const auto& reader : readers) sources_.push_back(std::make_unique<Source>(*reader));
  const std::size_t count = std::min(static_cast<std::size_t>(std::max(threads, 1)), sources_.size());
  threads_.reserve(count);
  const std::lock_guard lock(mutex_);  // none begins before it is known how many share the sources
  try {
    for (std::size_t thread = 0; thread < count; ++thread)
      threads_.push_back(NewThread([this, thread] { ReadAhead(thread); }));
  } catch (const std::system_error&) {
    if (threads_.empty()) throw;  // one reads them all too
  }
}

JoinedMissions::~JoinedMissions() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  room_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

// Of the sources of a thread, the one with the least ahead; null where none has room.
JoinedMissions::Source* JoinedMissions::Hungriest(std::size_t thread, bool& any_left) {
  Source* hungriest = nullptr;
  any_left = false;
  for (std::size_t i = thread; i < sources_.size(); i += threads_.size()) {
    Source* const source = sources_[i].get();
    if (source->ended) continue;
    any_left = true;
    if (source->ahead.size() < kBatchesAhead &&
        (hungriest == nullptr || source->ahead.size() < hungriest->ahead.size()))
      hungriest = source;
  }
  return hungriest;
}

void JoinedMissions::ReadAhead(std::size_t thread) {
  std::unique_lock lock(mutex_);
  for (bool any_left = true;;) {
    Source* source = nullptr;
    room_.wait(lock, [&] {
      source = Hungriest(thread, any_left);
      return stop_ || source != nullptr || !any_left;
    });
    if (stop_ || !any_left) return;
    lock.unlock();
    std::vector<ComparedMission> batch;
    bool ended = false;
    std::exception_ptr error;
    try {
      batch = source->ReadBatch(ended);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (!batch.empty()) source->ahead.push_back(std::move(batch));
    source->error = error;
    source->ended = ended || error != nullptr;
    filled_.notify_one();
  }
}

// To the source's next mission; false at its end.
bool JoinedMissions::Advance(std::size_t number) {
  Source& source = *sources_[number];
  if (++source.at < source.present.size()) return true;
  std::unique_lock lock(mutex_);
  filled_.wait(lock, [&] { return !source.ahead.empty() || source.ended; });
  if (source.ahead.empty()) {
    if (source.error) std::rethrow_exception(source.error);
    return false;
  }
  source.present = std::move(source.ahead.front());
  source.ahead.pop_front();
  source.at = 0;
  lock.unlock();
  room_.notify_all();
  return true;
}

void JoinedMissions::PushHead(std::size_t source) {
  if (!Advance(source)) return;
  const ComparedMission& mission = sources_[source]->present[sources_[source]->at];
  heads_.push_back({{mission.run, mission.mission}, source});
  std::push_heap(heads_.begin(), heads_.end(), std::greater<>());
}

const ComparedMission* JoinedMissions::Next() {
  if (begun_)
    PushHead(present_);
  else
    for (std::size_t source = 0; source < sources_.size(); ++source) PushHead(source);
  begun_ = true;
  if (heads_.empty()) return nullptr;
  std::pop_heap(heads_.begin(), heads_.end(), std::greater<>());
  present_ = heads_.back().second;
  heads_.pop_back();
  return &sources_[present_]->present[sources_[present_]->at];
}

}  // namespace ed3r::store
