// The life of a run directory: begun, continued, refused, killed, full.
#include "engine/store/store.h"

#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>

#include "engine/store/finished.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<ResultStore> OpenTest(const std::string& dir) {
  return ResultStore::Open(dir, TestRecipe(), TestLayout());
}

std::string Bytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> FilesIn(const std::string& dir) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(dir)) names.push_back(entry.path().filename().string());
  return names;
}

TEST(StoreTest, ContinuesWhereItStopped) {
  const TempDir temp;
  WriteStore(temp / "a/b/run", {{0, 0, 3}, {2, 1, 0}});
  const auto store = OpenTest(temp / "a/b/run");
  EXPECT_EQ(store->Stored(), (std::vector<sweep::RunId>{{0, 0, 3}, {2, 1, 0}}));
  store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0.5);
  EXPECT_EQ(store->Stored(), (std::vector<sweep::RunId>{{0, 0, 1}, {0, 0, 3}, {2, 1, 0}}));
}

TEST(StoreTest, WhatIsNotCommittedIsDropped) {
  const TempDir temp;
  {
    const auto store = OpenTest(temp / "run");
    store->Put({0, 0, 0}, TestRecord({0, 0, 0}), 0);
    store->Commit();
    store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0);
  }
  EXPECT_EQ(OpenTest(temp / "run")->Stored(), (std::vector<sweep::RunId>{{0, 0, 0}}));
}

TEST(StoreTest, AFinishedDirectoryIsOneFile) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  EXPECT_EQ(FilesIn(temp / "run"), std::vector<std::string>{kResultsFile});
  const std::string bytes = Bytes(ResultsIn(temp / "run"));
  EXPECT_EQ(DigestOfDir(temp / "run").size(), 64u);
  EXPECT_EQ(FilesIn(temp / "run"), std::vector<std::string>{kResultsFile}) << "reading leaves nothing behind";
  EXPECT_EQ(Bytes(ResultsIn(temp / "run")), bytes);
}

TEST(StoreTest, WhatIsRefusedBeforeAnythingIsStoredLeavesNothing) {
  const TempDir temp;
  for (const char* kind : {"local", "shared"}) {
    setenv("ED3R_STORE", kind, 1);
    OpenTest(temp / "a/b/run")->DiscardUnused();
    EXPECT_FALSE(fs::exists(temp / "a"));
    fs::create_directory(temp / "mine");
    OpenTest(temp / "mine/run/")->DiscardUnused();
    EXPECT_TRUE(fs::is_empty(temp / "mine")) << "what was there before stays";
    fs::remove(temp / "mine");
  }
  unsetenv("ED3R_STORE");
  {
    const auto store = OpenTest(temp / "run");
    store->PutFailure({0, 0, 1}, {"exception", "it happens"});
    store->DiscardUnused();
    store->Commit();
  }
  EXPECT_EQ(ResultReader(temp / "run").Failures().size(), 1u);
  OpenTest(temp / "run")->DiscardUnused();
  EXPECT_TRUE(fs::exists(ResultsIn(temp / "run"))) << "it was not made now";
}

TEST(StoreTest, AMissionIsStoredOnce) {
  const TempDir temp;
  const auto store = OpenTest(temp / "run");
  store->Put({0, 0, 0}, TestRecord({0, 0, 0}), 0);
  store->Commit();
  store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0);
  EXPECT_THROW(store->Put({0, 0, 0}, TestRecord({0, 0, 0}), 0), InternalError);
  EXPECT_THROW(store->Commit(), InternalError) << "half a group must not be committed";
  EXPECT_THROW(store->Put({0, 0, 2}, TestRecord({0, 0, 2}), 0), InternalError);
  EXPECT_EQ(store->Stored(), (std::vector<sweep::RunId>{{0, 0, 0}}));
}

TEST(StoreTest, MissionsOutsideThePlanAreRefused) {
  const TempDir temp;
  const auto store = OpenTest(temp / "run");
  for (const sweep::RunId& id : {sweep::RunId{0, 0, 40}, sweep::RunId{0, 1, 0}, sweep::RunId{1, 0, 0},
                                 sweep::RunId{3, 0, 0}, sweep::RunId{0, 0, -1}}) {
    EXPECT_THROW(store->Put(id, mission::MissionRecord{}, 0), InternalError);
    EXPECT_THROW(store->PutFailure(id, {"exception", "x"}), InternalError);
  }
}

TEST(StoreTest, FailuresAreKeptUntilTheMissionSucceeds) {
  const TempDir temp;
  {
    const auto store = OpenTest(temp / "run");
    store->PutFailure({2, 1, 4}, {"exception", "first\nmessage"});
    store->PutFailure({2, 1, 4}, {"ledger-adds-up", "second message"});
    store->PutFailure({2, 0, 1}, {"exception", "other"});
    store->Commit();
    EXPECT_TRUE(store->Stored().empty());
  }
  {
    const std::vector<FailedMission> failures = ResultReader(temp / "run").Failures();
    ASSERT_EQ(failures.size(), 2u);
    EXPECT_EQ(failures[0].id, (sweep::RunId{2, 0, 1}));
    EXPECT_EQ(failures[1].id, (sweep::RunId{2, 1, 4}));
    EXPECT_EQ(failures[1].kind, "ledger-adds-up");
    EXPECT_EQ(failures[1].message, "second message");
    EXPECT_EQ(failures[1].scenario, 5004);
    EXPECT_EQ(failures[1].seed, 7u);
  }
  const std::string before = DigestOfDir(temp / "run");
  WriteStore(temp / "run", {{2, 1, 4}});
  const std::vector<FailedMission> left = ResultReader(temp / "run").Failures();
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].id, (sweep::RunId{2, 0, 1}));
  EXPECT_NE(DigestOfDir(temp / "run"), before);
}

TEST(StoreTest, AnotherRecipeIsRefusedAndNothingChanges) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  const std::string bytes = Bytes(ResultsIn(temp / "run"));
  const auto error = [&](const std::function<void(Recipe&, RunLayout&)>& change) {
    Recipe recipe = TestRecipe();
    RunLayout layout = TestLayout();
    change(recipe, layout);
    return UserErrorOf([&] { ResultStore::Open(temp / "run", recipe, layout); });
  };
  const std::string plan = error([](Recipe& r, RunLayout&) { r.plan_text.replace(11, 7, "seed: 8"); });
  EXPECT_TRUE(Contains(plan, temp / "run"));
  EXPECT_TRUE(Contains(plan, "line 2: \"seed: 7\" there, \"seed: 8\" here"));
  EXPECT_TRUE(Contains(error([](Recipe& r, RunLayout&) { r.plan_text += "more\n"; }),
                       "line 5: nothing more there, \"more\" here"));
  EXPECT_TRUE(Contains(error([](Recipe& r, RunLayout&) { r.code["flight"] = {"4567"}; }),
                       "the code of flight is 0123abcd there and 4567 here"));
  EXPECT_TRUE(Contains(error([](Recipe& r, RunLayout&) { r.inputs["worlds/ridges.yaml"] = "other"; }),
                       "worlds/ridges.yaml is fingerprint-1 there and other here"));
  EXPECT_TRUE(Contains(error([](Recipe& r, RunLayout&) { r.inputs.clear(); }), "used there, but not here"));
  EXPECT_TRUE(
      Contains(error([](Recipe& r, RunLayout&) { r.inputs["b"] = "c"; }), "used here, but not there"));
  EXPECT_TRUE(Contains(error([](Recipe&, RunLayout& l) { l.stages[2].missions = 31; }), "other stages"));
  EXPECT_TRUE(Contains(error([](Recipe&, RunLayout& l) { l.seed = 8; }), "other stages, arms or seed"));
  EXPECT_EQ(Bytes(ResultsIn(temp / "run")), bytes);
  EXPECT_EQ(FilesIn(temp / "run"), std::vector<std::string>{kResultsFile});

  Recipe other_notes = TestRecipe();
  other_notes.notes = {{"simd", "scalar"}};
  EXPECT_NO_THROW(ResultStore::Open(temp / "run", other_notes, TestLayout()));
}

TEST(StoreTest, RecipeAndSessionsAreInTheFile) {
  const TempDir temp;
  RunLayout layout = TestLayout();
  layout.seed = 0xfedcba9876543210ULL;  // beyond int64
  Recipe recipe = TestRecipe();
  ResultStore::Open(temp / "run", recipe, layout)->Commit();
  recipe.notes["simd"] = "avx512";
  const auto running = ResultStore::Open(temp / "run", recipe, layout);

  ResultReader reader(temp / "run");
  EXPECT_EQ(reader.StoredRecipe().plan_text, recipe.plan_text);
  EXPECT_EQ(reader.StoredRecipe().code, recipe.code);
  EXPECT_EQ(reader.StoredRecipe().inputs, recipe.inputs);
  EXPECT_EQ(reader.Layout().name, "test");
  EXPECT_TRUE(reader.Layout().SameMissions(layout));
  std::vector<Session> sessions = reader.Sessions();
  ASSERT_EQ(sessions.size(), 2u);
  if (!sessions[1].ended_utc.empty()) std::swap(sessions[0], sessions[1]);  // begun within one second
  EXPECT_EQ(sessions[0].notes.at("simd"), "avx2");
  EXPECT_EQ(sessions[1].notes.at("simd"), "avx512");
  EXPECT_EQ(sessions[0].ended_utc.size(), std::string("2026-01-01T00:00:00Z").size());
  EXPECT_EQ(sessions[1].ended_utc, "");
  EXPECT_EQ(sessions[1].process, getpid());
}

// As a machine's name or a folder of the environment may be.
TEST(StoreTest, ATextThatIsNotUtf8CanBeReadAgain) {
  const TempDir temp;
  Recipe recipe = TestRecipe();
  recipe.notes["shipped sweeps"] = "/n\xfcrnberg/\xc3\xa9\xc3/\xff";
  ResultStore::Open(temp / "run", recipe, TestLayout())->Commit();
  EXPECT_EQ(ResultReader(temp / "run").Sessions().at(0).notes.at("shipped sweeps"),
            "/n\\xfcrnberg/\xc3\xa9\\xc3/\\xff");
}

TEST(StoreTest, ASecondWriterIsRefused) {
  const TempDir temp;
  {
    const auto first = OpenTest(temp / "run");
    const std::string error = UserErrorOf([&] { OpenTest(temp / "run"); });
    EXPECT_TRUE(Contains(error, (temp / "run") + ": another ed3r is writing into this directory"));
    EXPECT_TRUE(Contains(error, fmt::format("process {} on ", getpid())));
    first->Put({0, 0, 0}, TestRecord({0, 0, 0}), 0);
    first->Commit();
  }
  EXPECT_EQ(OpenTest(temp / "run")->Stored().size(), 1u);
}

TEST(StoreTest, AFileOfTwoNamesIsReadAndNotWritten) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  std::filesystem::create_directories(temp / "copy");
  std::filesystem::create_hard_link(ResultsIn(temp / "run"), ResultsIn(temp / "copy"));
  const std::string digest = DigestOfDir(temp / "copy");
  for (const char* name : {"run", "copy"})
    EXPECT_TRUE(Contains(UserErrorOf([&] { OpenTest(temp / name); }),
                         ResultsIn(temp / name) + ": this file has 2 names"));
  EXPECT_EQ(DigestOfDir(temp / "copy"), digest);
  std::filesystem::remove(ResultsIn(temp / "copy"));
  WriteStore(temp / "run", {{0, 0, 1}});
}

TEST(StoreTest, DirectoriesThatLinkToOneFileHaveOneWriter) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  for (const char* link : {"link", "other"}) {
    std::filesystem::create_directories(temp / link);
    std::filesystem::create_symlink(ResultsIn(temp / "run"), ResultsIn(temp / link));
  }
  for (const char* one : {"link", "run"}) {
    const auto first = OpenTest(temp / one);
    for (const char* another : {"run", "link", "other"})
      EXPECT_TRUE(Contains(UserErrorOf([&] { OpenTest(temp / another); }), ": another ed3r is writing"));
  }
  WriteStore(temp / "other", {{0, 0, 1}});
  EXPECT_EQ(ResultReader(temp / "run").Stored().size(), 2u);
}

TEST(StoreTest, ARunIsRememberedThroughALink) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  std::filesystem::create_directories(temp / "link");
  std::filesystem::create_symlink(ResultsIn(temp / "run"), ResultsIn(temp / "link"));
  {
    const auto writing = OpenTest(temp / "run");
    Remember(temp / "link", {"me", 1, "table", ""});
    EXPECT_FALSE(RecallFinished(temp / "link", "me")) << "somebody is at the file";
  }
  Remember(temp / "link", {"me", 1, "table", ""});
  EXPECT_TRUE(RecallFinished(temp / "run", "me"));
}

TEST(StoreTest, AFileThatAnotherTookThePlaceOfIsNotWritten) {
  const TempDir temp;
  WriteStore(temp / "backup", {{0, 0, 0}});
  const auto store = OpenTest(temp / "run");
  store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0);
  std::filesystem::rename(ResultsIn(temp / "backup"), ResultsIn(temp / "run"));
  EXPECT_THROW(store->Commit(), StoreError);
}

TEST(StoreTest, ALogThatWasTakenAwayIsNotWrittenOn) {
  const TempDir temp;
  {
    const auto store = OpenTest(temp / "run");
    store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0);
    store->Commit();
    std::filesystem::remove(ResultsIn(temp / "run") + "-wal");
    EXPECT_THROW(store->Put({0, 0, 2}, TestRecord({0, 0, 2}), 0), StoreError);
  }
  EXPECT_EQ(ResultReader(temp / "run").CountMissions(), 1) << "it comes home at the end";
  WriteStore(temp / "run", {{0, 0, 2}});
}

// cp keeps the inode.
TEST(StoreTest, AFileThatAnotherWasCopiedOverIsNotWritten) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  std::filesystem::create_directories(temp / "backup");
  std::filesystem::copy_file(ResultsIn(temp / "run"), ResultsIn(temp / "backup"));
  const std::string digest = DigestOfDir(temp / "backup");
  {
    const auto store = OpenTest(temp / "run");
    store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0);
    store->Commit();
    std::ofstream(ResultsIn(temp / "run"), std::ios::binary | std::ios::in)
        << std::ifstream(ResultsIn(temp / "backup"), std::ios::binary).rdbuf();
    EXPECT_THROW(store->Put({0, 0, 2}, TestRecord({0, 0, 2}), 0), StoreError);
  }
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { ResultReader reader(temp / "run"); }), "-wal is of another results"));
  std::filesystem::remove(ResultsIn(temp / "run") + "-wal");
  EXPECT_EQ(DigestOfDir(temp / "run"), digest);
}

// Forks a child that writes, and kills it when it says so. Returns once it is gone.
template <class Write>
void KillWriter(const Write& write) {
  int channel[2];
  ASSERT_EQ(pipe(channel), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto say_ready = [&] { return ::write(channel[1], "r", 1) == 1; };
    try {
      write(say_ready);
    } catch (...) {
    }
    _exit(1);
  }
  close(channel[1]);
  char byte = 0;
  EXPECT_EQ(read(channel[0], &byte, 1), 1) << "the writer failed before it was killed";
  close(channel[0]);
  ASSERT_EQ(kill(child, SIGKILL), 0);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST(StoreTest, AKillCostsOnlyTheOpenGroup) {
  const TempDir temp;
  const std::vector<sweep::RunId> all = AllMissions(TestLayout());
  KillWriter([&](const auto& say_ready) {
    const auto store = OpenTest(temp / "run");
    for (std::size_t i = 0; i < 60; ++i) {
      store->Put(all[i], TestRecord(all[i]), 0);
      if (i % 20 == 19) store->Commit();
    }
    for (std::size_t i = 60; i < 85; ++i) store->Put(all[i], TestRecord(all[i]), 0);
    say_ready();
    pause();
  });
  EXPECT_EQ(ResultReader(temp / "run").Stored(), std::vector<sweep::RunId>(all.begin(), all.begin() + 60))
      << "a reader sees the committed groups at once, before anybody repaired anything";
  WriteStore(temp / "run", {all.begin() + 60, all.end()});
  WriteStore(temp / "whole", all);
  EXPECT_EQ(DigestOfDir(temp / "run"), DigestOfDir(temp / "whole"));
  EXPECT_EQ(FilesIn(temp / "run"), std::vector<std::string>{kResultsFile});
}

TEST(StoreTest, AKillAtTheVeryStartLeavesADirectoryThatCanBeUsed) {
  const TempDir temp;
  fs::create_directories(temp / "run");
  std::ofstream(ResultsIn(temp / "run")).flush();  // SQLite makes the file before it writes into it
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader reader(temp / "run"); }), "no results in it yet"));
  WriteStore(temp / "run", {{0, 0, 0}});
  EXPECT_EQ(ResultReader(temp / "run").Stored().size(), 1u);
}

// Every write beyond `bytes` of a file fails, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit = {bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_ = {};
  void (*old_handler_)(int);
};

TEST(StoreTest, AFullDiskKeepsWhatWasCommitted) {
  const TempDir temp;
  const std::vector<sweep::RunId> all = AllMissions(TestLayout());
  std::size_t committed = 0;
  bool failed = false;
  {
    const FileSizeLimit limit(1024 * 1024);
    const auto store = OpenTest(temp / "run");
    try {
      for (; committed < all.size(); ++committed) {
        store->Put(all[committed], TestRecord(all[committed]), 0);
        store->Commit();
      }
    } catch (const StoreError& error) {
      failed = true;
      EXPECT_TRUE(Contains(error.what(), ResultsIn(temp / "run")));
      EXPECT_TRUE(Contains(error.what(), "disk I/O error"));
    }
    EXPECT_THROW(store->Commit(), InternalError);
  }
  ASSERT_TRUE(failed);
  ASSERT_GT(committed, 0u);
  EXPECT_EQ(ResultReader(temp / "run").Stored(),
            std::vector<sweep::RunId>(all.begin(), all.begin() + committed));
  WriteStore(temp / "run", {all.begin() + committed, all.end()});
  WriteStore(temp / "whole", all);
  EXPECT_EQ(DigestOfDir(temp / "run"), DigestOfDir(temp / "whole"));
}

}  // namespace
}  // namespace ed3r::store
