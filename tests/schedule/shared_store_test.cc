// Stores on file systems that several machines share, or that lack what a local disk has.
#include <filesystem>

#include "engine/store/owner_file.h"
#include "tests/schedule/dummy_process.h"

namespace ed3r::schedule {
namespace {

// Each as the shim (file_system_shim.c) or the user tells it.
struct Place {
  const char* name;
  std::vector<std::pair<const char*, const char*>> variables;
};

class SharedStoreTest : public testing::TestWithParam<Place> {
 protected:
  SharedStoreTest() {
    for (const auto& [variable, value] : GetParam().variables) setenv(variable, value, 1);
  }
  ~SharedStoreTest() override {
    for (const auto& [variable, value] : GetParam().variables) unsetenv(variable);
  }
};

const std::string kPreload = ED3R_SHIM;
// The shim comes before the runtime of a sanitizer, which does not mind.
constexpr std::pair kSanitized{"ASAN_OPTIONS", "verify_asan_link_order=0"};

INSTANTIATE_TEST_SUITE_P(
    Places, SharedStoreTest,
    testing::Values(Place{"told", {{"ED3R_STORE", "shared"}}},
                    Place{"no_flock",
                          {{"LD_PRELOAD", kPreload.c_str()}, {"SHIM_FLOCK", "missing"}, kSanitized}},
                    Place{"flock_does_nothing",
                          {{"LD_PRELOAD", kPreload.c_str()}, {"SHIM_FLOCK", "ignored"}, kSanitized}},
                    Place{"nothing_works",
                          {{"LD_PRELOAD", kPreload.c_str()},
                           {"SHIM_FLOCK", "ignored"},
                           {"SHIM_SHM", "fails"},
                           kSanitized}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(SharedStoreTest, AKillKeepsWhatIsStoredAndASecondWriterIsRefused) {
  const store::TempDir temp;
  DummyRun run(temp / "run", 2, 3, temp / "log");
  WaitFor([&] { return StoredIn(temp / "run") > 50; });
  EXPECT_FALSE(std::filesystem::exists(store::ResultsIn(temp / "run") + "-wal"));
  EXPECT_FALSE(std::filesystem::exists(store::ResultsIn(temp / "run") + "-shm"));

  ::testing::internal::CaptureStderr();
  EXPECT_EQ(DummyRun(temp / "run", 1, 0, temp / "log2").Wait(), 2);
  EXPECT_TRUE(store::Contains(::testing::internal::GetCapturedStderr(), "another ed3r is writing"));
  EXPECT_TRUE(ReadLog(temp / "log2").empty());

  run.Signal(SIGKILL);
  run.Wait();
  const std::size_t stored = store::ResultReader(temp / "run").Stored().size();  // rolls an open commit back
  EXPECT_GT(stored, 50u);
  EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log3").Wait(), 0);
  EXPECT_EQ(ReadLog(temp / "log3").size(), kMissions - stored) << "flies nothing that is stored";
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(temp / "run") / store::kOwnerFile));
}

TEST_P(SharedStoreTest, TwoWritersThatMeetInSpiteOfItLeaveRightResults) {
  const store::TempDir temp;
  DummyRun first(temp / "run", 2, 3, temp / "log");
  WaitFor([&] { return StoredIn(temp / "run") > 50; });
  std::filesystem::remove(std::filesystem::path(temp / "run") / store::kOwnerFile);
  DummyRun second(temp / "run", 2, 3, temp / "log2");
  first.Wait();
  second.Wait();
  // Whichever of them met the other's missions has ended; what is stored is right and continues.
  EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log3").Wait(), 0);
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
}

TEST(SharedMemoryTest, AStoreWithoutItIsWrittenAllTheSame) {
  setenv("LD_PRELOAD", ED3R_SHIM, 1);
  setenv("SHIM_SHM", "fails", 1);
  const store::TempDir temp;
  EXPECT_EQ(DummyRun(temp / "run", 2, 0, temp / "log").Wait(), 0);
  unsetenv("LD_PRELOAD");
  unsetenv("SHIM_SHM");
  EXPECT_EQ(store::DigestOfDir(temp / "run"), WholeDigest());
  EXPECT_FALSE(std::filesystem::exists(store::ResultsIn(temp / "run") + "-wal"));
}

TEST(OwnerFileTest, IsTakenOverOnlyFromAnOwnerThatIsGone) {
  const store::TempDir temp;
  const std::string dir = temp / "run", file = dir + "/" + store::kOwnerFile;
  std::filesystem::create_directories(dir);
  std::string owner;
  {
    const auto mine = store::OwnerFile::TryTake(dir, owner);
    ASSERT_NE(mine, nullptr);
    EXPECT_EQ(store::OwnerFile::TryTake(dir, owner), nullptr);
    EXPECT_TRUE(store::Contains(owner, fmt::format("process {} on ", getpid())));
  }
  EXPECT_FALSE(std::filesystem::exists(file));

  const auto left_by = [&](const std::string& text) { std::ofstream(file) << text; };
  left_by("elsewhere 12 - token\n");
  const auto now = std::filesystem::last_write_time(file);
  std::filesystem::last_write_time(file, now - store::kOwnerStale - std::chrono::seconds(5));
  EXPECT_NE(store::OwnerFile::TryTake(dir, owner), nullptr) << "not renewed for long";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir), {}), 0) << "nothing is left behind";
}

// Whether a directory whose owner file holds these words has a writer that may be alive.
bool MayBeAlive(const std::string& dir, const std::string& words, std::string& owner) {
  std::ofstream(dir + "/" + store::kOwnerFile) << words << "\n";
  return store::OwnerFile::TryTake(dir, owner) == nullptr;
}

TEST(OwnerFileTest, AProcessNumberIsBelievedOnlyWhereItIsCountedAlike) {
  const store::TempDir temp;
  const std::string dir = temp / "run";
  std::filesystem::create_directories(dir);
  std::string owner, host, process, job, token, start, numbers;
  {
    const auto mine = store::OwnerFile::TryTake(dir, owner);
    std::ifstream(dir + "/" + store::kOwnerFile) >> host >> process >> job >> token >> start >> numbers;
  }
  ASSERT_TRUE(store::Contains(numbers, "/pid:["));
  const std::string gone = fmt::format("{} {} - token", host, 1 << 30);  // no kernel counts so far
  EXPECT_FALSE(MayBeAlive(dir, fmt::format("{} 0 {}", gone, numbers), owner));
  EXPECT_TRUE(MayBeAlive(dir, fmt::format("{} 0 {}0", gone, numbers), owner)) << "another container";
  EXPECT_TRUE(MayBeAlive(dir, fmt::format("{} 0 0{}", gone, numbers), owner))
      << "another machine of that name";
  EXPECT_TRUE(MayBeAlive(dir, gone, owner)) << "of an earlier program, which did not say";
  EXPECT_EQ(owner, fmt::format("process {} on {}", 1 << 30, host));
  EXPECT_TRUE(MayBeAlive(dir, fmt::format("{} {} - token 0 {}", host, getpid(), numbers), owner));
}

TEST(OwnerFileTest, AJobThatIsStartedAgainTakesOverAndAnotherTaskOfItsStartDoesNot) {
  const store::TempDir temp;
  std::filesystem::create_directories(temp / "run");
  std::string owner;
  EXPECT_TRUE(MayBeAlive(temp / "run", "elsewhere 12 4711 token 0 boot/pid:[1]", owner));
  EXPECT_EQ(owner, "process 12 on elsewhere, job 4711");
  setenv("SLURM_JOB_ID", "4711", 1);
  EXPECT_TRUE(MayBeAlive(temp / "run", "elsewhere 12 4711 token 0 boot/pid:[1]", owner))
      << "two tasks of one srun";
  EXPECT_TRUE(MayBeAlive(temp / "run", "elsewhere 12 4711 token", owner)) << "of an earlier program";
  setenv("SLURM_RESTART_COUNT", "1", 1);
  EXPECT_TRUE(MayBeAlive(temp / "run", "elsewhere 12 4712 token 0 boot/pid:[1]", owner)) << "another job";
  EXPECT_FALSE(MayBeAlive(temp / "run", "elsewhere 12 4711 token 0 boot/pid:[1]", owner));
  unsetenv("SLURM_RESTART_COUNT");
  unsetenv("SLURM_JOB_ID");
}

}  // namespace
}  // namespace ed3r::schedule
