// What only whole processes can show: kill -9, Ctrl-C, a limit on threads, two runs in one directory.
#include <algorithm>

#include "tests/schedule/dummy_process.h"

namespace ed3r::schedule {
namespace {

TEST(ProcessTest, AKillCostsLessThanASecondAndResumesToTheSameDigest) {
  const store::TempDir temp;
  DummyRun run(temp / "run", 2, 3, temp / "log");
  WaitFor([&] { return StoredIn(temp / "run") > 100; });
  std::this_thread::sleep_for(milliseconds(700));  // somewhere between two commits
  run.Signal(SIGKILL);
  EXPECT_EQ(run.Wait(), -SIGKILL);
  const std::int64_t killed_ns = steady_clock::now().time_since_epoch().count();

  const std::vector<sweep::RunId> stored = store::ResultReader(temp / "run").Stored();
  EXPECT_LT(stored.size(), static_cast<std::size_t>(kMissions));
  const std::vector<Flown> flown = ReadLog(temp / "log");
  int early = 0;
  for (const Flown& mission : flown) {
    if (killed_ns - mission.time_ns < 1'000'000'000) continue;
    ++early;
    EXPECT_TRUE(std::binary_search(stored.begin(), stored.end(), sweep::RunId{0, 0, mission.mission}));
  }
  EXPECT_GT(early, 0);

  EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log2").Wait(), 0);
  EXPECT_EQ(ReadLog(temp / "log2").size(), kMissions - stored.size()) << "flies nothing that is stored";
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
}

TEST(ProcessTest, CtrlCAndABatchSystemsSignalsKeepWhatIsStored) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU}) {
    const store::TempDir temp;
    DummyRun run(temp / "run", 2, 3, temp / "log");
    WaitFor([&] { return ReadLog(temp / "log").size() > 20; });
    run.Signal(signal);
    EXPECT_EQ(run.Wait(), signal == SIGINT ? 130 : 75);
    const std::int64_t stored = StoredIn(temp / "run");
    const auto flown = static_cast<std::int64_t>(ReadLog(temp / "log").size());
    EXPECT_GE(stored, flown - 2) << "only those may be missing that came back while it stopped";
    EXPECT_FALSE(std::filesystem::exists(store::ResultsIn(temp / "run") + "-wal")) << "closed in order";
    EXPECT_TRUE(store::ResultReader(temp / "run").Failures().empty());
    EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log2").Wait(), 0);
    EXPECT_EQ(static_cast<std::int64_t>(ReadLog(temp / "log2").size()), kMissions - stored);
    EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
  }
}

TEST(ProcessTest, ASecondRunInTheSameDirectoryIsRefused) {
  const store::TempDir temp;
  DummyRun run(temp / "run", 2, 3, temp / "log");
  WaitFor([&] { return StoredIn(temp / "run") > 0; });
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(DummyRun(temp / "run", 1, 0, temp / "log2").Wait(), 2);
  EXPECT_TRUE(store::Contains(::testing::internal::GetCapturedStderr(), "another ed3r is writing"));
  EXPECT_TRUE(ReadLog(temp / "log2").empty());
}

TEST(ProcessTest, FewerThreadsThanAskedAreNotTakenSilently) {
  const store::TempDir temp;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(DummyRun(temp / "run", 3, 0, temp / "log", "OMP_THREAD_LIMIT=2").Wait(), 2);
  EXPECT_TRUE(store::Contains(::testing::internal::GetCapturedStderr(), "2 of 3 threads"));
  EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log", "OMP_THREAD_LIMIT=2").Wait(), 0);
}

TEST(ProcessTest, OmpDynamicDoesNotTakeThreadsAway) {
  const store::TempDir temp;
  EXPECT_EQ(DummyRun(temp / "run", 8, 0, temp / "log", "OMP_DYNAMIC=true").Wait(), 0);
}

}  // namespace
}  // namespace ed3r::schedule
