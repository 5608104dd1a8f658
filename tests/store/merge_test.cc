#include "engine/store/shards/merge.h"

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <memory>

#include "engine/store/shards/joined_missions.h"
#include "engine/store/sqlite.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

std::vector<sweep::RunId> Every(int step, int first) {
  std::vector<sweep::RunId> some;
  const std::vector<sweep::RunId> all = AllMissions(TestLayout());
  for (std::size_t i = first; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

class MergeTest : public ::testing::Test {
 protected:
  MergeTest() {
    for (int shard = 0; shard < 3; ++shard) WriteStore(Shard(shard), Every(3, shard));
    WriteStore(temp_ / "whole", AllMissions(TestLayout()));
  }
  std::string Shard(int i) const { return temp_ / fmt::format("shard{}", i); }
  std::vector<std::string> Shards() const { return {Shard(0), Shard(1), Shard(2)}; }

  TempDir temp_;
};

TEST_F(MergeTest, ShardsMakeTheWhole) {
  const MergeSummary summary = MergeStores(temp_ / "out", Shards());
  EXPECT_EQ(summary.added, 100);
  EXPECT_EQ(summary.present, 0);
  EXPECT_EQ(DigestOfDir(temp_ / "out"), DigestOfDir(temp_ / "whole"));
  ResultReader out(temp_ / "out");
  EXPECT_EQ(out.Sessions().size(), 3u);
  EXPECT_EQ(out.Status()[0].wall_s, 40 * 0.25);
  EXPECT_EQ(out.Sessions()[0].notes.at("simd"), "avx2");
}

TEST_F(MergeTest, AgainAndOverlapping) {
  MergeStores(temp_ / "out", {Shard(0), Shard(1)});
  const MergeSummary again = MergeStores(temp_ / "out", {Shard(1), Shard(2), temp_ / "whole", Shard(2)});
  EXPECT_EQ(again.added, 33);
  EXPECT_EQ(again.present, 33 + 100 + 33);
  const std::string digest = DigestOfDir(temp_ / "out");
  EXPECT_EQ(digest, DigestOfDir(temp_ / "whole"));
  const std::size_t sessions = ResultReader(temp_ / "out").Sessions().size();
  const MergeSummary nothing = MergeStores(temp_ / "out", {Shard(1), Shard(2), temp_ / "whole", Shard(2)});
  EXPECT_EQ(nothing.added, 0);
  EXPECT_EQ(DigestOfDir(temp_ / "out"), digest);
  EXPECT_EQ(ResultReader(temp_ / "out").Sessions().size(), sessions);
}

TEST_F(MergeTest, IntoOneOfThem) {
  const MergeSummary summary = MergeStores(Shard(0), Shards());
  EXPECT_EQ(summary.added, 66);
  EXPECT_EQ(summary.present, 0);
  EXPECT_EQ(DigestOfDir(Shard(0)), DigestOfDir(temp_ / "whole"));
  EXPECT_FALSE(fs::exists(ResultsIn(Shard(0)) + "-wal"));
  EXPECT_EQ(MergeStores(Shard(0), {Shard(0)}).added, 0);
}

TEST_F(MergeTest, ALinkToTheStoreIsTheStore) {
  fs::create_directories(temp_ / "link");
  fs::create_symlink(ResultsIn(Shard(0)), ResultsIn(temp_ / "link"));
  const std::string digest = DigestOfDir(Shard(0));
  EXPECT_EQ(MergeStores(Shard(0), {temp_ / "link"}).added, 0);
  EXPECT_EQ(DigestOfDir(Shard(0)), digest);
}

// Stores mission {2, 0, 7} with one column off by one unit in the last place.
void WriteConflict(const std::string& dir, bool in_step) {
  const sweep::RunId id{2, 0, 7};
  mission::MissionRecord record = TestRecord(id);
  ASSERT_GT(record.steps.size(), 0u);
  double& value = in_step ? record.steps.back().scs : record.total_j;
  value = std::nextafter(value, 1e9);
  const auto store = ResultStore::Open(dir, TestRecipe(), TestLayout());
  store->Put({0, 0, 0}, TestRecord({0, 0, 0}), 0);
  store->Put(id, record, 0);
  store->Commit();
}

TEST_F(MergeTest, AConflictIsRefusedAndNothingChanges) {
  for (const bool in_step : {false, true}) {
    const std::string odd = temp_ / fmt::format("odd{}", in_step);
    WriteConflict(odd, in_step);
    MergeStores(temp_ / "out", {Shard(0)});
    const std::string digest = DigestOfDir(temp_ / "out");
    std::string error = UserErrorOf([&] { MergeStores(temp_ / "out", {odd, Shard(1), Shard(2)}); });
    EXPECT_TRUE(Contains(error, "stage online, arm rbs, mission 7"));
    EXPECT_EQ(DigestOfDir(temp_ / "out"), digest);
    // A new directory disappears again.
    error = UserErrorOf([&] { MergeStores(temp_ / "new", {temp_ / "whole", odd}); });
    EXPECT_TRUE(Contains(error, odd));
    EXPECT_FALSE(fs::exists(temp_ / "new"));
  }
}

TEST_F(MergeTest, AnotherRecipeIsRefused) {
  const auto refused = [&](const std::string& name, const Recipe& recipe, const std::string& part) {
    WriteStore(temp_ / name, {{0, 0, 0}}, recipe);
    EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(temp_ / "new", {Shard(0), temp_ / name}); }), part));
    EXPECT_FALSE(fs::exists(temp_ / "new"));
    const std::string digest = DigestOfDir(temp_ / name);
    EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(temp_ / name, Shards()); }), part));
    EXPECT_EQ(DigestOfDir(temp_ / name), digest);
  };
  Recipe code = TestRecipe(), plan = TestRecipe(), world = TestRecipe();
  code.code["flight"] = {"ffff"};
  plan.plan_text += "x";
  world.inputs.begin()->second = "other";
  refused("code", code, "the code of flight is");
  refused("plan", plan, "the plan differs at its line 5");
  refused("world", world, "worlds/ridges.yaml is");
}

TEST_F(MergeTest, AMissingDirectoryIsRefused) {
  EXPECT_TRUE(Contains(UserErrorOf([&] {
                         MergeStores(temp_ / "new", {Shard(0), temp_ / "none"});
                       }),
                       "no such directory"));
  EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(temp_ / "new", {}); }), "nothing to merge"));
  EXPECT_FALSE(fs::exists(temp_ / "new"));
}

TEST_F(MergeTest, AFailureCountsOnlyWhereNobodyHasTheMission) {
  {
    const auto store = ResultStore::Open(temp_ / "failed", TestRecipe(), TestLayout());
    store->PutFailure({0, 0, 0}, {"exception", "flown by shard 0"});
    store->PutFailure({0, 0, 1}, {"exception", "flown by shard 1"});
    store->PutFailure({0, 0, 2}, {"exception", "flown by shard 2"});
    store->Commit();
  }
  const MergeSummary summary = MergeStores(temp_ / "out", {Shard(0), temp_ / "failed", Shard(1)});
  EXPECT_EQ(summary.failed, 1);
  const std::vector<FailedMission> failures = ResultReader(temp_ / "out").Failures();
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_EQ(failures[0].id, (sweep::RunId{0, 0, 2}));
  EXPECT_EQ(failures[0].message, "flown by shard 2");
  EXPECT_EQ(MergeStores(temp_ / "out", Shards()).failed, 0);
  EXPECT_EQ(DigestOfDir(temp_ / "out"), DigestOfDir(temp_ / "whole"));
}

// More than are read side by side, in any order, some missions in several of them.
TEST_F(MergeTest, ManyStoresInAnyOrder) {
  std::vector<std::string> stores;
  for (int shard = 0; shard < 140; ++shard) {
    stores.push_back(temp_ / fmt::format("many{}", shard));
    WriteStore(stores.back(), Every(70, shard % 70));
  }
  const std::string whole = DigestOfDir(temp_ / "whole");
  MergeSummary summary = MergeStores(temp_ / "out", stores);
  EXPECT_EQ(summary.added, 100);
  EXPECT_EQ(summary.present, 100);
  EXPECT_EQ(DigestOfDir(temp_ / "out"), whole);
  std::reverse(stores.begin(), stores.end());
  summary = MergeStores(temp_ / "back", stores);
  EXPECT_EQ(summary.added, 100);
  EXPECT_EQ(DigestOfDir(temp_ / "back"), whole);
  EXPECT_EQ(ResultReader(temp_ / "back").Sessions().size(), 140u);
}

TEST_F(MergeTest, ADamagedMissionOfAnyStoreIsRefused) {
  MergeStores(temp_ / "out", {Shard(0)});
  const std::string digest = DigestOfDir(temp_ / "out");
  for (const char* harm : {"UPDATE timesteps SET scs = scs + 1 WHERE run = 2",
                           "UPDATE missions SET total_j = total_j + 1 WHERE run = 3 AND mission = 3",
                           "UPDATE missions SET checksum = steps_checksum WHERE run = 0 AND mission = 1"}) {
    WriteStore(temp_ / "harmed", Every(3, 1));
    {
      Connection database(ResultsIn(temp_ / "harmed"), Connection::Access::kReadWrite);
      database.Execute(harm);
      ASSERT_GT(database.Int("SELECT changes()"), 0) << harm;
    }
    for (const char* out : {"out", "new"})
      EXPECT_TRUE(Contains(UserErrorOf([&] {
                             MergeStores(temp_ / out, {Shard(2), temp_ / "harmed", Shard(1)});
                           }),
                           "harmed/results.sqlite: stage"))
          << harm;
    EXPECT_EQ(DigestOfDir(temp_ / "out"), digest);
    EXPECT_FALSE(fs::exists(temp_ / "new"));
    fs::remove_all(temp_ / "harmed");
  }
}

// Whenever it is: what was there is whole, and the same merge again completes it.
TEST_F(MergeTest, AKilledMergeIsMadeAgain) {
  const std::string whole = DigestOfDir(temp_ / "whole");
  for (int moment = 0; moment < 16; ++moment) {
    const std::string out = temp_ / fmt::format("killed{}", moment);
    if (moment % 2 == 1) MergeStores(out, {Shard(0)});
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      MergeStores(out, Shards());
      pause();
    }
    usleep(static_cast<useconds_t>(1500 * moment));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    if (moment % 2 == 1) {
      EXPECT_TRUE(ResultReader(out).FindDamage().empty());
    }
    EXPECT_EQ(MergeStores(out, Shards()).failed, 0);
    EXPECT_EQ(DigestOfDir(out), whole) << moment;
  }
}

TEST_F(MergeTest, MissionsOfManyStoresComeInPlanOrder) {
  std::vector<std::unique_ptr<ResultReader>> readers;
  for (const std::string& dir : {Shard(2), temp_ / "whole", Shard(0)})
    readers.push_back(std::make_unique<ResultReader>(dir));
  JoinedMissions all(readers, 2);
  std::vector<std::pair<sweep::RunId, std::size_t>> found;
  while (const ComparedMission* mission = all.Next()) {
    found.push_back({mission->id, all.source()});
    EXPECT_EQ(DigestOf(mission->record), DigestOf(TestRecord(mission->id)));
  }
  EXPECT_EQ(all.Next(), nullptr);
  EXPECT_EQ(found.size(), 100u + 67u);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  JoinedMissions left_alone(readers, 3);  // goes without having been asked for all
  EXPECT_NE(left_alone.Next(), nullptr);
}

TEST_F(MergeTest, ADirectoryWithAWriterIsRefused) {
  const auto store = ResultStore::Open(Shard(0), TestRecipe(), TestLayout());
  EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(Shard(0), {Shard(1)}); }), "another ed3r is writing"));
}

}  // namespace
}  // namespace ed3r::store
