// What only whole processes can show: kill -9, Ctrl-C, a limit on threads, two runs in one directory.
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

#include "tests/store/store_fixture.h"

extern char** environ;

namespace ed3r {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kMissions = 2000;

class DummyRun {
 public:
  DummyRun(const std::string& dir, int threads, int delay_ms, const std::string& log,
           const std::string& environment = "") {
    std::vector<std::string> words = {
        ED3R_DUMMY_RUN,           dir, std::to_string(kMissions), std::to_string(threads),
        std::to_string(delay_ms), log};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::string extra = environment;
    std::vector<char*> variables;
    for (char** variable = environ; *variable != nullptr; ++variable) variables.push_back(*variable);
    if (!extra.empty()) variables.push_back(extra.data());
    variables.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&process_, ED3R_DUMMY_RUN, nullptr, nullptr, arguments.data(), variables.data()),
              0);
  }
  ~DummyRun() {
    if (running_) Signal(SIGKILL), Wait();
  }
  DummyRun(const DummyRun&) = delete;
  DummyRun& operator=(const DummyRun&) = delete;

  void Signal(int signal) const { kill(process_, signal); }

  // The exit status, or minus the signal that ended it.
  int Wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    running_ = false;
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  pid_t process_ = -1;
  bool running_ = true;
};

std::int64_t StoredIn(const std::string& dir) {
  try {
    return static_cast<std::int64_t>(ResultReader(dir).Stored().size());
  } catch (const UserError&) {  // not begun yet
    return 0;
  }
}

void WaitFor(const std::function<bool()>& condition) {
  const auto deadline = steady_clock::now() + std::chrono::seconds(60);
  while (!condition() && steady_clock::now() < deadline) std::this_thread::sleep_for(milliseconds(10));
  ASSERT_TRUE(condition());
}

struct Flown {
  int mission = 0;
  std::int64_t time_ns = 0;
};

std::vector<Flown> ReadLog(const std::string& file) {
  std::vector<Flown> flown;
  std::ifstream in(file);
  for (Flown line; in >> line.mission >> line.time_ns;) flown.push_back(line);
  return flown;
}

std::string WholeDigest() {
  static const std::string digest = [] {
    const TempDir temp;
    RunLayout layout = TestLayout();
    layout.stages[0].missions = kMissions;
    {
      const auto store = ResultStore::Open(temp / "whole", TestRecipe(), layout);
      for (int m = 0; m < kMissions; ++m) store->Put({0, 0, m}, TestRecord({0, 0, m}), 0);
      store->Commit();
    }
    return DigestOfDir(temp / "whole");
  }();
  return digest;
}

TEST(ProcessTest, AKillCostsLessThanASecondAndResumesToTheSameDigest) {
  const TempDir temp;
  DummyRun run(temp / "run", 2, 3, temp / "log");
  WaitFor([&] { return StoredIn(temp / "run") > 100; });
  std::this_thread::sleep_for(milliseconds(700));  // somewhere between two commits
  run.Signal(SIGKILL);
  EXPECT_EQ(run.Wait(), -SIGKILL);
  const std::int64_t killed_ns = steady_clock::now().time_since_epoch().count();

  const std::vector<RunId> stored = ResultReader(temp / "run").Stored();
  EXPECT_LT(stored.size(), static_cast<std::size_t>(kMissions));
  const std::vector<Flown> flown = ReadLog(temp / "log");
  int early = 0;
  for (const Flown& mission : flown) {
    if (killed_ns - mission.time_ns < 1'000'000'000) continue;
    ++early;
    EXPECT_TRUE(std::binary_search(stored.begin(), stored.end(), RunId{0, 0, mission.mission}));
  }
  EXPECT_GT(early, 0);

  EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log2").Wait(), 0);
  EXPECT_EQ(ReadLog(temp / "log2").size(), kMissions - stored.size()) << "flies nothing that is stored";
  EXPECT_EQ(DigestOfDir(temp / "run"), WholeDigest());
}

TEST(ProcessTest, CtrlCAndABatchSystemsSignalsKeepWhatIsStored) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
    const TempDir temp;
    DummyRun run(temp / "run", 2, 3, temp / "log");
    WaitFor([&] { return ReadLog(temp / "log").size() > 20; });
    run.Signal(signal);
    EXPECT_EQ(run.Wait(), signal == SIGINT ? 130 : 75);
    const std::int64_t stored = StoredIn(temp / "run");
    const auto flown = static_cast<std::int64_t>(ReadLog(temp / "log").size());
    EXPECT_GE(stored, flown - 2) << "only those may be missing that came back while it stopped";
    EXPECT_FALSE(std::filesystem::exists(ResultsIn(temp / "run") + "-wal")) << "closed in order";
    EXPECT_TRUE(ResultReader(temp / "run").Failures().empty());
    EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log2").Wait(), 0);
    EXPECT_EQ(static_cast<std::int64_t>(ReadLog(temp / "log2").size()), kMissions - stored);
    EXPECT_EQ(DigestOfDir(temp / "run"), WholeDigest());
  }
}

TEST(ProcessTest, ASecondRunInTheSameDirectoryIsRefused) {
  const TempDir temp;
  DummyRun run(temp / "run", 2, 3, temp / "log");
  WaitFor([&] { return StoredIn(temp / "run") > 0; });
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(DummyRun(temp / "run", 1, 0, temp / "log2").Wait(), 2);
  EXPECT_TRUE(Contains(::testing::internal::GetCapturedStderr(), "another ed3r is writing"));
  EXPECT_TRUE(ReadLog(temp / "log2").empty());
}

TEST(ProcessTest, FewerThreadsThanAskedAreNotTakenSilently) {
  const TempDir temp;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(DummyRun(temp / "run", 3, 0, temp / "log", "OMP_THREAD_LIMIT=2").Wait(), 2);
  EXPECT_TRUE(Contains(::testing::internal::GetCapturedStderr(), "2 of 3 threads"));
  EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log", "OMP_THREAD_LIMIT=2").Wait(), 0);
}

TEST(ProcessTest, OmpDynamicDoesNotTakeThreadsAway) {
  const TempDir temp;
  EXPECT_EQ(DummyRun(temp / "run", 8, 0, temp / "log", "OMP_DYNAMIC=true").Wait(), 0);
}

}  // namespace
}  // namespace ed3r
