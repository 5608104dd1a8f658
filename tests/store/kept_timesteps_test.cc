#include "engine/sweep/kept_timesteps.h"

#include "engine/store/damage.h"
#include "engine/store/difference.h"
#include "engine/store/shards/merge.h"
#include "engine/store/sqlite.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

// Of TestLayout(): the warm-up keeps all timesteps, the online stage those that `online` says.
Recipe RecipeThatKeeps(const std::string& online) {
  Recipe recipe = TestRecipe();
  recipe.plan_text =
      "sweep=test\nseed=7\nstage=warmup\narm=warmup\nstage=train\narm=train-75\nstage=online\n";
  if (online != "all") recipe.plan_text += "timesteps=" + online + "\n";
  recipe.plan_text += "arm=rbs\narm=ed3r-75\n";
  return recipe;
}

// As TestRecord, with every outcome among them.
mission::MissionRecord Flown(const sweep::RunId& id) {
  mission::MissionRecord record = TestRecord(id);
  record.outcome = id.mission % 3;
  return record;
}

void WriteFlown(const std::string& dir, const std::string& online, int shard = 0, int shards = 1) {
  const auto store = ResultStore::Open(dir, RecipeThatKeeps(online), TestLayout());
  const std::vector<sweep::RunId> all = AllMissions(TestLayout());
  for (std::size_t i = static_cast<std::size_t>(shard); i < all.size(); i += static_cast<std::size_t>(shards))
    store->Put(all[i], Flown(all[i]), 0.25);
  store->Commit();
}

std::int64_t CountSteps(const std::string& dir, const std::string& where = "1") {
  Connection database(ResultsIn(dir), Connection::Access::kReadOnly);
  return database.Int(
      fmt::format("SELECT count(*) FROM timesteps JOIN missions USING (run, mission) WHERE {}", where));
}

class KeptTimestepsTest : public ::testing::Test {
 protected:
  KeptTimestepsTest() {
    for (const char* kept : {"all", "failed", "none"}) WriteFlown(temp_ / kept, kept);
  }
  TempDir temp_;
};

TEST_F(KeptTimestepsTest, LeavesOutWhatThePlanSays) {
  const std::int64_t warmup = CountSteps(temp_ / "all", "run = 0");
  ASSERT_GT(warmup, 0);
  EXPECT_EQ(CountSteps(temp_ / "none", "run = 0"), warmup);
  EXPECT_EQ(CountSteps(temp_ / "none", "run > 0"), 0);
  EXPECT_EQ(CountSteps(temp_ / "failed", "run > 0 AND outcome = 0"), 0);
  const std::int64_t failed = CountSteps(temp_ / "all", "run > 0 AND outcome != 0");
  ASSERT_GT(failed, 0);
  EXPECT_EQ(CountSteps(temp_ / "failed", "run > 0 AND outcome != 0"), failed);
}

TEST_F(KeptTimestepsTest, TheDigestIsTheSame) {
  EXPECT_EQ(DigestOfDir(temp_ / "none"), DigestOfDir(temp_ / "all"));
  EXPECT_EQ(DigestOfDir(temp_ / "failed"), DigestOfDir(temp_ / "all"));
}

TEST_F(KeptTimestepsTest, ShardsMakeTheWhole) {
  for (const std::string kept : {"failed", "none"}) {
    std::vector<std::string> shards;
    for (int i = 0; i < 3; ++i)
      WriteFlown(shards.emplace_back(temp_ / fmt::format("{}{}", kept, i)), kept, i, 3);
    MergeStores(temp_ / ("merged" + kept), shards);
    MergeStores(temp_ / ("merged" + kept), {temp_ / kept});
    EXPECT_EQ(DigestOfDir(temp_ / ("merged" + kept)), DigestOfDir(temp_ / "all"));
    EXPECT_EQ(CountSteps(temp_ / ("merged" + kept)), CountSteps(temp_ / kept));
    EXPECT_TRUE(ResultReader(temp_ / ("merged" + kept)).FindDamage().empty());
  }
  EXPECT_TRUE(
      Contains(UserErrorOf([&] {
                 MergeStores(temp_ / "mixed", {temp_ / "all", temp_ / "none"});
               }),
               "cannot be merged: stage online stores timesteps of all missions there and of none here"));
}

TEST_F(KeptTimestepsTest, AFlightThatDiffersInATimestepIsSeenWithoutThem) {
  const sweep::RunId id{2, 0, 7};
  mission::MissionRecord record = Flown(id);
  ASSERT_FALSE(record.steps.empty());
  ResultReader none(temp_ / "none");
  EXPECT_TRUE(none.IsStored(record, none.LoadMission(id)));
  record.steps.back().scs = std::nextafter(record.steps.back().scs, 1e9);
  EXPECT_FALSE(none.IsStored(record, none.LoadMission(id)));
  {
    const auto odd = ResultStore::Open(temp_ / "odd", RecipeThatKeeps("none"), TestLayout());
    odd->Put(id, record, 0.25);
    odd->Commit();
  }
  EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(temp_ / "none", {temp_ / "odd"}); }), "differs"));
  ResultReader odd(temp_ / "odd"), all(temp_ / "all");
  const RunDifference difference = DiffRuns(odd, all);
  EXPECT_EQ(difference.compared, 1);
  EXPECT_EQ(difference.differing, 1);
  EXPECT_EQ(DiffRuns(none, all).differing, 0);
  EXPECT_EQ(DiffRuns(none, all).compared, 100);
}

TEST_F(KeptTimestepsTest, DamageIsFoundOnBothSides) {
  {
    Connection database(ResultsIn(temp_ / "failed"), Connection::Access::kCreate);
    database.Execute("DELETE FROM timesteps WHERE run = 2 AND mission = 7");  // a failed one: 7 % 3 == 1
    database.Execute("UPDATE timesteps SET mission = 6 WHERE run = 2 AND mission = 10");
  }
  const std::vector<DamagedMission> damage = ResultReader(temp_ / "failed").FindDamage();
  ASSERT_EQ(damage.size(), 3u);
  EXPECT_EQ(damage[0].mission, 6);
  EXPECT_TRUE(Contains(damage[0].what, "which its sweep leaves out"));
  EXPECT_EQ(damage[1].mission, 7);
  EXPECT_TRUE(Contains(damage[1].what, "timesteps do not match"));
  EXPECT_EQ(damage[2].mission, 10);
}

TEST_F(KeptTimestepsTest, WhatNeedsThemRefuses) {
  ResultReader reader(temp_ / "none");
  EXPECT_NO_THROW(reader.NeedTimesteps(0));
  const std::string refusal = UserErrorOf([&] { reader.ForEachTimestep(2, 0, [](int, const auto&) {}); });
  EXPECT_TRUE(Contains(
      refusal, "stage online: the timesteps are needed, and its sweep says store: {timesteps: none}"));
  EXPECT_TRUE(reader.LoadMission({0, 0, 1}).keeps_timesteps);
  EXPECT_FALSE(reader.LoadMission({2, 1, 1}).keeps_timesteps);
}

TEST(KeptTimestepsOfPlanTest, ReadsThemByStage) {
  EXPECT_EQ(
      sweep::ReadKeptTimesteps(RecipeThatKeeps("failed").plan_text),
      (std::vector{sweep::KeptTimesteps::kAll, sweep::KeptTimesteps::kAll, sweep::KeptTimesteps::kFailed}));
  EXPECT_TRUE(
      Contains(UserErrorOf([] { sweep::ReadKeptTimesteps("stage=a\ntimesteps=some\n"); }), "timesteps=some"));
}

}  // namespace
}  // namespace ed3r::store
