// Many stores as one: tallied in place, merged, and a finished one remembered.
#include "engine/store/shards/shards.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

#include "engine/store/finished.h"
#include "engine/store/shards/merge.h"
#include "engine/store/tally.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

// The missions of TestLayout() dealt among as many stores.
std::vector<std::string> WriteShards(const std::string& run, int shards) {
  const std::vector<sweep::RunId> all = AllMissions(TestLayout());
  std::vector<std::string> dirs;
  for (int shard = 0; shard < shards; ++shard) {
    std::vector<sweep::RunId> mine;
    for (std::size_t i = static_cast<std::size_t>(shard); i < all.size();
         i += static_cast<std::size_t>(shards))
      mine.push_back(all[i]);
    dirs.push_back(fmt::format("{}/shards/online/{:05}", run, shard));
    WriteStore(dirs.back(), mine);
  }
  return dirs;
}

TEST(ShardDirsTest, AreThoseWithResults) {
  const TempDir temp;
  EXPECT_TRUE(ShardDirs(temp / "run").empty());
  const std::vector<std::string> dirs = WriteShards(temp / "run", 3);
  fs::create_directories(temp / "run/shards/online/00009");
  fs::create_directories(temp / "run/shards/warmup");
  EXPECT_EQ(ShardDirs(temp / "run"), dirs);
  EXPECT_EQ(ShardDirs(temp / "run", "online"), dirs);
  EXPECT_TRUE(ShardDirs(temp / "run", "warmup").empty());
}

TEST(TallyTest, CountsEachMissionOnceOverAllStores) {
  const TempDir temp;
  const std::vector<std::string> dirs = WriteShards(temp / "run", 4);
  {
    const auto store = ResultStore::Open(temp / "extra", TestRecipe(), TestLayout());
    store->PutFailure({0, 0, 1}, {"bad-input", "done elsewhere"});
    store->PutFailure({2, 0, 5}, {"bad-input", "done elsewhere"});
    store->Commit();
  }
  Tally tally(TestRecipe(), TestLayout());
  for (const int shard : {0, 1, 2}) tally.Add(dirs[static_cast<std::size_t>(shard)]);
  tally.Add(dirs[0]);
  tally.Add(temp / "extra");
  const std::vector<ArmStatus> arms = tally.Arms();
  ASSERT_EQ(arms.size(), 4u);
  std::int64_t done = 0, failed = 0;
  for (const ArmStatus& arm : arms) {
    done += arm.done, failed += arm.failed;
    EXPECT_EQ(arm.done + arm.failed + arm.missing, arm.planned);
  }
  EXPECT_EQ(done, 75);
  // Missions 1 and 45 in plan order: of them shard 1 holds both.
  EXPECT_EQ(failed, 0);

  Tally failures(TestRecipe(), TestLayout());
  failures.Add(temp / "extra");
  EXPECT_EQ(failures.Arms()[0].failed, 1);
  EXPECT_EQ(failures.Arms()[0].done, 0);
}

TEST(TallyTest, AnotherLayoutIsRefused) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  RunLayout other = TestLayout();
  other.stages[0].missions = 41;
  Tally tally(TestRecipe(), other);
  EXPECT_TRUE(Contains(UserErrorOf([&] { tally.Add(temp / "run"); }), "its stages, arms or seed differ"));
}

TEST(TallyTest, AnotherRecipeOrCodeIsRefused) {
  const TempDir temp;
  Recipe windy = TestRecipe(), coded = TestRecipe();
  windy.inputs["worlds/ridges.yaml"] = "fingerprint-2";
  coded.code["flight"] = {"beef"};
  WriteStore(temp / "windy", {{0, 0, 1}}, windy);
  WriteStore(temp / "coded", {{0, 0, 2}}, coded);
  Tally tally(TestRecipe(), TestLayout());
  EXPECT_TRUE(Contains(UserErrorOf([&] { tally.Add(temp / "windy"); }), "fingerprint-1 there and "));
  EXPECT_TRUE(Contains(UserErrorOf([&] { tally.Add(temp / "coded"); }), "code of flight"));
  EXPECT_EQ(tally.Arms()[0].done, 0);
}

TEST(MergeShardsTest, MoreStoresThanAreReadAtOnceInAnyOrder) {
  const TempDir temp;
  WriteStore(temp / "whole", AllMissions(TestLayout()));
  std::vector<std::string> dirs = WriteShards(temp / "run", 100);
  std::vector<std::string> twice = dirs;
  twice.insert(twice.end(), dirs.begin(), dirs.end());
  std::shuffle(twice.begin(), twice.end(), std::mt19937(1));
  const MergeSummary summary = MergeStores(temp / "out", twice);
  EXPECT_EQ(summary.added, 100);
  EXPECT_EQ(summary.present, 100);
  EXPECT_EQ(DigestOfDir(temp / "out"), DigestOfDir(temp / "whole"));
}

TEST(FinishedTest, IsBelievedWhileTheFileIsUntouched) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  const std::string digest = DigestOfDir(temp / "run");
  EXPECT_FALSE(RecallFinished(temp / "run", "this"));
  Remember(temp / "run", {"this", 100, "a table\n", "networks\n"});
  const auto finished = RecallFinished(temp / "run", "this");
  ASSERT_TRUE(finished);
  EXPECT_EQ(finished->missions, 100);
  EXPECT_EQ(finished->table, "a table\n");
  EXPECT_EQ(finished->networks, "networks\n");
  EXPECT_FALSE(RecallFinished(temp / "run", "another program"));
  EXPECT_EQ(DigestOfDir(temp / "run"), digest);

  fs::last_write_time(ResultsIn(temp / "run"), fs::file_time_type::clock::now());
  EXPECT_FALSE(RecallFinished(temp / "run", "this")) << "written to by whatever";
  Remember(temp / "run", {"this", 100, "", ""});
  ASSERT_TRUE(RecallFinished(temp / "run", "this"));
  const auto time = fs::last_write_time(ResultsIn(temp / "run"));
  Connection(ResultsIn(temp / "run"), Connection::Access::kReadWrite)
      .Execute("UPDATE timings SET wall_s = 1");
  fs::last_write_time(ResultsIn(temp / "run"), time);
  EXPECT_FALSE(RecallFinished(temp / "run", "this")) << "SQLite counts every change";
}

// A bit of the text that would be printed, below SQLite and with the file's times as they were.
TEST(FinishedTest, WhatWasPrintedIsChecked) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 1}});
  const std::string file = ResultsIn(temp / "run"), table = "total 10.99 kJ in a table of its own\n";
  Remember(temp / "run", {"this", 1, table, "networks\n"});
  ASSERT_TRUE(RecallFinished(temp / "run", "this"));
  const auto time = fs::last_write_time(file);
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  const std::size_t at = bytes.rfind(table);
  ASSERT_NE(at, std::string::npos);
  {
    std::fstream out(file, std::ios::binary | std::ios::in | std::ios::out);
    out.seekp(static_cast<std::streamoff>(at + 6));
    out.put('2');
  }
  fs::last_write_time(file, time);
  EXPECT_FALSE(RecallFinished(temp / "run", "this"));
}

// Between flying and remembering a table is printed, which may stand still for hours.
TEST(FinishedTest, NotWhatAnotherProcessHasMadeOfTheRun) {
  const TempDir temp;
  const std::string run = temp / "run", plan = TestRecipe().plan_text;
  WriteStore(run, {{0, 0, 1}});
  const FileMoment told = LookAtFile(run);
  RememberFinished(run, told, plan + "x", {"this", 1, "", ""});
  EXPECT_FALSE(RecallFinished(run, "this")) << "another plan";
  RememberFinished(run, told, plan, {"this", 2, "", ""});
  EXPECT_FALSE(RecallFinished(run, "this")) << "other missions";
  WriteStore(run, {{0, 0, 2}});
  RememberFinished(run, told, plan, {"this", 2, "", ""});
  EXPECT_FALSE(RecallFinished(run, "this")) << "another state";
  WriteStore(temp / "other", {{0, 0, 1}, {0, 0, 2}});
  const FileMoment of_both = LookAtFile(run);
  fs::rename(ResultsIn(temp / "other"), ResultsIn(run));
  RememberFinished(run, of_both, plan, {"this", 2, "", ""});
  EXPECT_FALSE(RecallFinished(run, "this")) << "another file";
  Remember(run, {"this", 2, "", ""});
  EXPECT_TRUE(RecallFinished(run, "this"));
}

TEST(FinishedTest, NotWhileAnotherProcessWrites) {
  const TempDir temp;
  const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
  Remember(temp / "run", {"this", 0, "", ""});
  EXPECT_FALSE(RecallFinished(temp / "run", "this"));
}

}  // namespace
}  // namespace ed3r::store
