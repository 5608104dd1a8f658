#include "engine/schedule/scheduler.h"

#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "engine/core/interrupt.h"
#include "engine/mission/invariants.h"
#include "engine/perception/vision/frame_detector.h"
#include "engine/schedule/todo.h"
#include "tests/store/store_fixture.h"

namespace ed3r::schedule {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

mission::MissionRecord FlyTest(const sweep::RunId& id, const std::atomic<bool>&) {
  return store::TestRecord(id);
}

std::vector<sweep::RunId> TodoOf(const store::ResultStore& store) {
  std::vector<sweep::RunId> todo;
  for (int stage = 0; stage < 3; ++stage)
    for (const sweep::RunId& id : Todo(store.Layout(), stage, Shard{}, store.Stored())) todo.push_back(id);
  return todo;
}

std::unique_ptr<store::ResultStore> OpenTest(const std::string& dir) {
  return store::ResultStore::Open(dir, store::TestRecipe(), store::TestLayout());
}

std::string WholeDigest() {
  const store::TempDir temp;
  store::WriteStore(temp / "whole", store::AllMissions(store::TestLayout()));
  return store::DigestOfDir(temp / "whole");
}

// A store in memory that can be slow or fail, and notes what happened.
class FakeStore final : public store::ResultStore {
 public:
  const store::RunLayout& Layout() const override { return layout_; }
  std::string Grown() const override { return ""; }
  bool HasGrown() const override { return false; }
  void Grow() override {}
  store::FlownNetworks Networks() const override { return {}; }
  std::vector<store::DamagedMission> Repaired() const override { return {}; }
  std::vector<sweep::RunId> Stored() const override { return {}; }
  void Put(const sweep::RunId& id, const mission::MissionRecord&, double wall_s) override {
    std::this_thread::sleep_for(put_takes);
    if (++puts == fail_at) throw store::StoreError("disk full");
    EXPECT_GE(wall_s, 0);
    if (!oldest_) oldest_ = steady_clock::now();
    ids.insert(id);
  }
  std::vector<sweep::RunId> Failed() const override { return {}; }
  void PutFailure(const sweep::RunId&, const store::Failure&) override { ++failures; }
  std::vector<store::DamagedMission> FindDamage() override { return {}; }
  void Remove(const std::vector<store::DamagedMission>&) override {}
  void PutNetworks(const store::FlownNetworks&) override {}
  void PutNote(const std::string&, const std::string&) override {}
  void Commit() override {
    ++commits;
    if (oldest_) longest_wait = std::max(longest_wait, steady_clock::now() - *oldest_);
    oldest_.reset();
  }

  milliseconds put_takes{0};
  int fail_at = 0;
  std::atomic<int> puts{0};
  int failures = 0, commits = 0;
  std::set<sweep::RunId> ids;
  steady_clock::duration longest_wait{};

 private:
  store::RunLayout layout_ = store::TestLayout();
  std::optional<steady_clock::time_point> oldest_;
};

TEST(SchedulerTest, DigestDependsNeitherOnThreadsNorOnOrder) {
  const std::string whole = WholeDigest();
  for (const int threads : {1, 2, 5}) {
    for (const Order order : {Order::kNatural, Order::kReversed, Order::kShuffled}) {
      const store::TempDir temp;
      {
        const auto store = OpenTest(temp / "run");
        const RunSummary summary = RunMissions(Arrange(TodoOf(*store), order, 3), FlyTest, *store,
                                               {.threads = threads, .commit_every = milliseconds(1)});
        EXPECT_EQ(summary.stored, 100);
        EXPECT_EQ(summary.failed, 0);
        EXPECT_EQ(summary.dropped, 0);
        EXPECT_EQ(summary.threads, threads);
        EXPECT_FALSE(summary.interrupted);
      }
      EXPECT_EQ(store::DigestOfDir(temp / "run"), whole);
    }
  }
}

TEST(SchedulerTest, SumsUpWhatItFlew) {
  const store::TempDir temp;
  const auto store = OpenTest(temp / "run");
  const std::vector<sweep::RunId> todo = TodoOf(*store);
  const RunSummary summary = RunMissions(todo, FlyTest, *store, {.threads = 2});
  double simulated_s = 0;
  for (const sweep::RunId& id : todo) simulated_s += store::TestRecord(id).duration_s;
  EXPECT_NEAR(summary.simulated_s, simulated_s, 1e-6);
  EXPECT_GT(summary.wall_s, 0);
  EXPECT_TRUE(TodoOf(*store).empty());
  EXPECT_EQ(RunMissions({}, FlyTest, *store, {.threads = 2}).stored, 0);
}

// Each mission waits until as many are in flight as threads were asked for: with fewer threads it would fail.
TEST(SchedulerTest, FliesThatManyMissionsAtOnce) {
  constexpr int kThreads = 6;
  FakeStore store;
  std::atomic<int> in_flight{0};
  const auto fly = [&](const sweep::RunId& id, const std::atomic<bool>&) {
    ++in_flight;
    const auto deadline = steady_clock::now() + std::chrono::seconds(20);
    while (in_flight < kThreads) {
      if (steady_clock::now() > deadline) throw std::runtime_error("alone");
      std::this_thread::yield();
    }
    return store::TestRecord(id);
  };
  const RunSummary summary =
      RunMissions(Todo(store.Layout(), 0, Shard{}, {}), fly, store, {.threads = kThreads});
  EXPECT_EQ(summary.stored, 40);
  EXPECT_EQ(summary.failed, 0);
}

TEST(SchedulerTest, ThreadNumbersAreChecked) {
  EXPECT_EQ(ThreadsFor(3), 3);
  EXPECT_GE(ThreadsFor(0), 1);
  EXPECT_TRUE(store::Contains(store::UserErrorOf([] { ThreadsFor(-1); }), "--threads: -1"));
  EXPECT_TRUE(store::Contains(store::UserErrorOf([] { ThreadsFor(5000); }), "--threads: 5000"));
}

TEST(SchedulerTest, AMissionThatThrowsIsAFailedOneAndTheSweepGoesOn) {
  const store::TempDir temp;
  const auto fly = [](const sweep::RunId& id, const std::atomic<bool>&) {
    mission::MissionRecord record = store::TestRecord(id);
    if (id == sweep::RunId{0, 0, 3}) throw std::runtime_error("the battery caught fire");
    if (id == sweep::RunId{2, 0, 5}) throw UserError("no such model");
    if (id == sweep::RunId{2, 0, 6}) throw perception::DetectorError("mine.onnx: answers not a number");
    if (id == sweep::RunId{2, 1, 0}) throw 42;
    if (id == sweep::RunId{2, 1, 2}) throw std::bad_alloc();
    if (id == sweep::RunId{2, 1, 3})
      throw mission::BrokenInvariant(mission::Invariant::kPositionInWorld, "timestep 3: z_m is -2");
    if (id == sweep::RunId{2, 1, 1})
      record.steps.assign(2, mission::TimestepRecord{});  // two timesteps with one number
    return record;
  };
  {
    const auto store = OpenTest(temp / "run");
    const RunSummary summary = RunMissions(TodoOf(*store), fly, *store, {.threads = 2});
    EXPECT_EQ(summary.stored, 93);
    EXPECT_EQ(summary.failed, 7);
    EXPECT_EQ(summary.dropped, 0);
    EXPECT_FALSE(summary.interrupted);
  }
  const std::vector<store::FailedMission> failures = store::ResultReader(temp / "run").Failures();
  ASSERT_EQ(failures.size(), 7u);
  std::vector<std::string> kinds;
  for (const store::FailedMission& failure : failures) kinds.push_back(failure.kind);
  EXPECT_EQ(kinds, (std::vector<std::string>{"exception", "bad-input", "detector-answer", "exception",
                                             "broken-check", "out-of-memory", "position-in-world"}));
  EXPECT_EQ(failures[0].message, "the battery caught fire");
  EXPECT_EQ(failures[0].scenario, 3);
  EXPECT_EQ(failures[0].seed, 7u);
  EXPECT_EQ(failures[1].message, "no such model");
  EXPECT_EQ(failures[1].scenario, 5005);
  EXPECT_EQ(failures[2].message, "mine.onnx: answers not a number");
  EXPECT_EQ(failures[3].message, "an exception of unknown type");
  EXPECT_TRUE(store::Contains(failures[4].message, "timestep 0 follows timestep 0"));
  {
    const auto store = OpenTest(temp / "run");
    EXPECT_EQ(TodoOf(*store),
              (std::vector<sweep::RunId>{
                  {0, 0, 3}, {2, 0, 5}, {2, 0, 6}, {2, 1, 0}, {2, 1, 1}, {2, 1, 2}, {2, 1, 3}}));
    EXPECT_EQ(store->Failed(), TodoOf(*store));
    EXPECT_EQ(RunMissions(TodoOf(*store), FlyTest, *store, {.threads = 2}).stored, 7);
  }
  EXPECT_TRUE(store::ResultReader(temp / "run").Failures().empty());
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
}

TEST(SchedulerTest, StopDropsMissionsInFlightAndKeepsTheRest) {
  const store::TempDir temp;
  std::atomic<bool> ctrl_c{false};
  std::atomic<int> flown{0}, interrupted{0};
  const auto fly = [&](const sweep::RunId& id, const std::atomic<bool>& stop) {
    if (++flown < 30) return store::TestRecord(id);
    ctrl_c = true;
    while (!stop) std::this_thread::yield();
    // Some notice and say so, others come back with half a mission.
    if (++interrupted % 2 == 0) throw Interrupted();
    return mission::MissionRecord{};
  };
  {
    const auto store = OpenTest(temp / "run");
    const RunSummary summary = RunMissions(TodoOf(*store), fly, *store, {.threads = 2, .stop = &ctrl_c});
    EXPECT_TRUE(summary.interrupted);
    EXPECT_EQ(summary.failed, 0);
    EXPECT_LE(summary.stored, 29);
    EXPECT_GE(summary.stored, 28) << "all but the one that another thread may have been handing over";
    EXPECT_EQ(summary.stored + summary.dropped, 100);
    EXPECT_LE(flown, 31) << "nothing is begun after the stop";
  }
  EXPECT_TRUE(store::ResultReader(temp / "run").Failures().empty());
  const auto store = OpenTest(temp / "run");
  RunMissions(TodoOf(*store), FlyTest, *store, {.threads = 2});
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
}

// Its message cannot be copied, as when there is no memory for it.
struct Untold : std::exception {
  const char* what() const noexcept override { return nullptr; }
};

TEST(SchedulerTest, AFailureThatCannotBeToldEndsTheRunAndWhatCameBeforeIsKept) {
  const store::TempDir temp;
  {
    const auto store = OpenTest(temp / "run");
    const auto fly = [&](const sweep::RunId& id, const std::atomic<bool>&) {
      if (id == sweep::RunId{2, 0, 5}) throw Untold();
      return store::TestRecord(id);
    };
    EXPECT_THROW(RunMissions(TodoOf(*store), fly, *store, {.threads = 2}), std::logic_error);
  }
  EXPECT_GE(store::ResultReader(temp / "run").Stored().size(), 40u);
  const auto store = OpenTest(temp / "run");
  RunMissions(TodoOf(*store), FlyTest, *store, {.threads = 2});
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
}

TEST(SchedulerTest, InterruptedWithoutACauseIsNotSilent) {
  FakeStore store;
  const auto fly = [&](const sweep::RunId& id, const std::atomic<bool>&) {
    if (id.mission == 7) throw Interrupted();
    return store::TestRecord(id);
  };
  const RunSummary summary = RunMissions(Todo(store.Layout(), 0, Shard{}, {}), fly, store, {.threads = 2});
  EXPECT_EQ(summary.stored, 39);
  EXPECT_EQ(summary.dropped, 1);
  EXPECT_TRUE(summary.interrupted);
}

TEST(SchedulerTest, AFailingStoreStopsTheSweepWithOneError) {
  FakeStore store;
  store.fail_at = 10;
  std::atomic<int> flown{0};
  const auto fly = [&](const sweep::RunId& id, const std::atomic<bool>& stop) {
    ++flown;
    for (int i = 0; i < 2 && !stop; ++i) std::this_thread::sleep_for(milliseconds(1));
    return store::TestRecord(id);
  };
  std::vector<sweep::RunId> todo;
  for (int m = 0; m < 5000; ++m) todo.push_back({0, 0, m});
  EXPECT_THROW(RunMissions(todo, fly, store, {.threads = 4}), store::StoreError);
  EXPECT_EQ(store.puts, 10) << "a store that failed is left alone";
  EXPECT_LT(flown, 200);
}

TEST(SchedulerTest, AFullDiskKeepsWhatWasCommitted) {
  const store::TempDir temp;
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old = {};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit limit = {1024 * 1024, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  try {
    const auto store = OpenTest(temp / "run");
    const auto fly = [](const sweep::RunId& id, const std::atomic<bool>&) {
      std::this_thread::sleep_for(milliseconds(2));
      return store::TestRecord(id);
    };
    EXPECT_THROW(RunMissions(TodoOf(*store), fly, *store, {.threads = 2, .commit_every = milliseconds(0)}),
                 store::StoreError);
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  const auto store = OpenTest(temp / "run");
  const std::size_t kept = store->Stored().size();
  EXPECT_GT(kept, 0u);
  EXPECT_LT(kept, 100u);
  EXPECT_EQ(RunMissions(TodoOf(*store), FlyTest, *store, {.threads = 2}).stored,
            static_cast<std::int64_t>(100 - kept));
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
}

TEST(SchedulerTest, CommitsTwiceASecond) {
  FakeStore store;
  const auto fly = [](const sweep::RunId& id, const std::atomic<bool>&) {
    std::this_thread::sleep_for(milliseconds(70));
    return store::TestRecord(id);
  };
  const RunSummary summary = RunMissions(Todo(store.Layout(), 0, Shard{}, {}), fly, store, {.threads = 2});
  EXPECT_GE(summary.wall_s, 1.4);
  EXPECT_GE(store.commits, 2);
  EXPECT_LE(store.commits, summary.wall_s / 0.5 + 1) << "in groups, not one by one";
  EXPECT_LT(store.longest_wait, std::chrono::seconds(1));
}

// Also when the store is slow: then the threads wait for it instead of piling up records.
TEST(SchedulerTest, ASlowStoreHoldsTheMissionsBack) {
  FakeStore store;
  store.put_takes = milliseconds(4);
  std::atomic<int> flown{0};
  std::atomic<int> most_waiting{0};
  const auto fly = [&](const sweep::RunId& id, const std::atomic<bool>&) {
    most_waiting = std::max(most_waiting.load(), ++flown - store.puts);
    return store::TestRecord(id);
  };
  std::vector<sweep::RunId> todo;
  for (int m = 0; m < 100; ++m) todo.push_back({0, 0, m});
  RunMissions(todo, fly, store, {.threads = 2});
  EXPECT_EQ(store.puts, 100);
  EXPECT_LE(most_waiting, 4 * 2 + 2 + 1 + 1)
      << "queue, one per thread in hand, one at the writer, one read late";
  EXPECT_GT(most_waiting, 4);
}

TEST(SchedulerTest, PrintsNothingWhereNobodyLooks) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  FakeStore store;
  const auto fly = [](const sweep::RunId& id, const std::atomic<bool>&) {
    std::this_thread::sleep_for(milliseconds(10));
    return store::TestRecord(id);
  };
  RunMissions(Todo(store.Layout(), 0, Shard{}, {}), fly, store, {.threads = 2, .progress = file});
  EXPECT_EQ(std::ftell(file), 0);
  std::fclose(file);
}

}  // namespace
}  // namespace ed3r::schedule
