#include "engine/store/reader.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <thread>

#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

TEST(ReaderTest, MissionsComeInPlanOrderWhateverTheOrderOfArrival) {
  const TempDir temp;
  std::vector<sweep::RunId> all = AllMissions(TestLayout());
  std::reverse(all.begin(), all.end());
  WriteStore(temp / "run", all);
  std::reverse(all.begin(), all.end());
  ResultReader reader(temp / "run");
  std::vector<sweep::RunId> seen;
  reader.ForEachMission(Steps::kLoad, [&](const StoredMission& mission) {
    seen.push_back(mission.id);
    EXPECT_EQ(CanonicalBytes(mission.record), CanonicalBytes(TestRecord(mission.id)));
    EXPECT_EQ(mission.wall_s, 0.25);
    EXPECT_NE(mission.session, 0);
  });
  EXPECT_EQ(seen, all);
  EXPECT_EQ(reader.Stored(), all);
}

TEST(ReaderTest, AFileThatTookThePlaceOfTheOneThatIsReadIsTold) {
  const TempDir temp;
  WriteStore(temp / "run", {{2, 1, 17}});
  WriteStore(temp / "other", {{2, 1, 17}});
  ResultReader reader(temp / "run");
  reader.CheckNotReplaced();
  std::filesystem::remove(temp / "run/results.sqlite");
  reader.CheckNotReplaced();  // nothing that could be taken for it
  std::filesystem::rename(temp / "other/results.sqlite", temp / "run/results.sqlite");
  EXPECT_EQ(UserErrorOf([&] { reader.CheckNotReplaced(); }),
            temp / "run/results.sqlite" +
                ": was replaced since it was opened; open it again (the same command does)");
  EXPECT_EQ(reader.CountMissions(), 1);
}

TEST(ReaderTest, OneArmAlone) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  ResultReader reader(temp / "run");
  std::vector<sweep::RunId> seen;
  reader.ForEachMission(2, 1, Steps::kSkip, [&](const StoredMission& mission) {
    seen.push_back(mission.id);
    EXPECT_TRUE(mission.record.steps.empty());
    EXPECT_EQ(mission.record.total_j, TestRecord(mission.id).total_j);
  });
  ASSERT_EQ(seen.size(), 30u);
  EXPECT_EQ(seen.front(), (sweep::RunId{2, 1, 0}));
  EXPECT_EQ(seen.back(), (sweep::RunId{2, 1, 29}));

  std::vector<std::pair<int, double>> steps, wanted;
  reader.ForEachTimestep(2, 1, [&](int mission, const mission::TimestepRecord& step) {
    steps.emplace_back(mission, step.total_j);
  });
  for (const sweep::RunId& id : seen)
    for (const mission::TimestepRecord& step : TestRecord(id).steps)
      wanted.emplace_back(id.mission, step.total_j);
  EXPECT_EQ(steps, wanted);
}

TEST(ReaderTest, OneMission) {
  const TempDir temp;
  WriteStore(temp / "run", {{2, 1, 17}});
  ResultReader reader(temp / "run");
  EXPECT_EQ(CanonicalBytes(reader.LoadMission({2, 1, 17}).record), CanonicalBytes(TestRecord({2, 1, 17})));
  EXPECT_TRUE(Contains(UserErrorOf([&] {
                         reader.LoadMission({2, 1, 16});
                       }),
                       "stage online, arm ed3r-75, mission 16 is not stored"));
  EXPECT_TRUE(Contains(UserErrorOf([&] { reader.LoadMission({2, 1, 30}); }), "no mission 30"));
}

// As a writer leaves it that is ended while it writes the file's first page: a rollback journal, and half a change.
TEST(ReaderTest, AJournalThatAWriterLeftIsRolledBack) {
  const TempDir temp;
  WriteStore(temp / "run", {{2, 1, 17}});
  const std::string digest = DigestOfDir(temp / "run"), file = ResultsIn(temp / "run");
  const pid_t child = fork();
  if (child == 0) {
    Connection database(file, Connection::Access::kReadWrite);
    database.Execute(
        "PRAGMA cache_size = 1; PRAGMA cache_spill = ON; BEGIN IMMEDIATE; UPDATE missions SET total_j = 0; "
        "CREATE "
        "TABLE more (x); INSERT INTO more SELECT randomblob(200000) FROM runs; UPDATE more SET x = "
        "randomblob(300000)");
    std::raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_GT(std::filesystem::file_size(file + "-journal"), 0u);
  EXPECT_EQ(DigestOfDir(temp / "run"), digest);
  EXPECT_FALSE(std::filesystem::exists(file + "-journal"));
}

TEST(ReaderTest, StatusCountsDoneFailedAndMissing) {
  const TempDir temp;
  {
    const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
    for (int i = 0; i < 12; ++i) store->Put({0, 0, i}, TestRecord({0, 0, i}), 0.5);
    store->PutFailure({0, 0, 30}, {"exception", "broken"});
    store->Put({2, 1, 3}, TestRecord({2, 1, 3}), 0.5);
    store->Commit();
  }
  const std::vector<ArmStatus> status = ResultReader(temp / "run").Status();
  ASSERT_EQ(status.size(), 4u);
  EXPECT_EQ(status[0].stage, "warmup");
  EXPECT_EQ(status[0].planned, 40);
  EXPECT_EQ(status[0].done, 12);
  EXPECT_EQ(status[0].failed, 1);
  EXPECT_EQ(status[0].missing, 27);
  EXPECT_EQ(status[0].wall_s, 6.0);
  double simulated_s = 0;
  for (int i = 0; i < 12; ++i) simulated_s += TestRecord({0, 0, i}).duration_s;
  EXPECT_NEAR(status[0].simulated_s, simulated_s, 1e-9);
  EXPECT_EQ(status[1].stage, "train");
  EXPECT_EQ(status[1].planned, 0);
  EXPECT_EQ(status[1].missing, 0);
  EXPECT_EQ(status[2].arm, "rbs");
  EXPECT_EQ(status[2].missing, 30);
  EXPECT_EQ(status[3].stage, "online");
  EXPECT_EQ(status[3].arm, "ed3r-75");
  EXPECT_EQ(status[3].done, 1);
}

// A reader looks on while a writer commits: it always sees whole groups of five, and never fewer than before.
TEST(ReaderTest, LooksOnWhileAnotherWrites) {
  const TempDir temp;
  const std::vector<sweep::RunId> all = AllMissions(TestLayout());
  auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
  std::atomic<bool> done{false};
  std::atomic<int> looks{0};
  std::thread watcher([&] {
    ResultReader reader(temp / "run");
    std::size_t before = 0;
    while (!done) {
      const std::vector<sweep::RunId> stored = reader.Stored();
      EXPECT_EQ(stored.size() % 5, 0u);
      EXPECT_GE(stored.size(), before);
      before = stored.size();
      std::int64_t counted = 0;
      for (const ArmStatus& arm : reader.Status()) counted += arm.done;
      EXPECT_GE(counted, static_cast<std::int64_t>(before));
      EXPECT_EQ(DigestOf(reader).size(), 64u);
      ++looks;
    }
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    store->Put(all[i], TestRecord(all[i]), 0);
    if (i % 5 != 4) continue;
    store->Commit();
    for (const int seen = looks; looks == seen && i < 50;) std::this_thread::yield();
  }
  store.reset();  // closes while the reader is still there
  done = true;
  watcher.join();
  EXPECT_GE(looks, 10);
  WriteStore(temp / "whole", all);
  EXPECT_EQ(DigestOfDir(temp / "run"), DigestOfDir(temp / "whole"));
}

}  // namespace
}  // namespace ed3r::store
