// A run whose plan asks for more of the same goes on; one that asks for something else is refused and stays as it is.
#include "engine/store/growth.h"

#include "engine/config/parameters.h"
#include "engine/store/shards/joined_missions.h"
#include "engine/store/shards/merge.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

sweep::Arm ArmOf(const std::string& name, const std::string& strategy, double mass_kg = 1.8) {
  sweep::Arm arm;
  arm.name = name;
  arm.config.mission.strategy = strategy;
  arm.config.robot.mass_kg = mass_kg;
  return arm;
}

// One stage, an axis of masses.
sweep::SweepPlan Masses(const std::vector<double>& masses_kg, int missions) {
  sweep::SweepPlan plan{.name = "masses", .question = "", .file = "", .seed = 7, .stages = {sweep::Stage()}};
  plan.stages[0].name = "online";
  plan.stages[0].missions = missions;
  for (const double mass_kg : masses_kg)
    plan.stages[0].arms.push_back(ArmOf(fmt::format("rbs,mass_kg={}", mass_kg), "rbs", mass_kg));
  return plan;
}

// Warm-up, training, online.
sweep::SweepPlan Learning(const std::vector<std::string>& warmups, int warmup_missions, int online_missions) {
  sweep::SweepPlan plan{.name = "learning", .question = "", .file = "", .seed = 7, .stages = {}};
  plan.stages.push_back(
      {.name = "warmup", .after = {}, .missions = warmup_missions, .precision = {}, .arms = {}});
  for (const std::string& name : warmups) plan.stages[0].arms.push_back(ArmOf(name, "random"));
  plan.stages.push_back({.name = "training",
                         .kind = sweep::StageKind::kTrain,
                         .after = {"warmup"},
                         .precision = {},
                         .arms = {ArmOf("training", "rbs")}});
  plan.stages.push_back({.name = "online",
                         .after = {"training"},
                         .missions = online_missions,
                         .precision = {},
                         .arms = {ArmOf("ed3r-75", "ed3r")}});
  return plan;
}

Recipe RecipeOf(const sweep::SweepPlan& plan) {
  Recipe recipe = TestRecipe();
  recipe.plan_text = plan.CanonicalText();
  return recipe;
}

std::unique_ptr<ResultStore> Open(const std::string& dir, const sweep::SweepPlan& plan) {
  return ResultStore::Open(dir, RecipeOf(plan), LayoutOf(plan));
}

// What the plan has got.
std::string Grow(const std::string& dir, const sweep::SweepPlan& plan) {
  const auto store = Open(dir, plan);
  store->Grow();
  return store->Grown();
}

// What an arm's mission leaves, wherever the arm stands in the plan.
mission::MissionRecord RecordOf(const sweep::SweepPlan& plan, const sweep::RunId& id) {
  const sweep::Arm& arm =
      plan.stages[static_cast<std::size_t>(id.stage)].arms[static_cast<std::size_t>(id.arm)];
  int key = 0;
  for (const char c : arm.name) key = (31 * key + c) % 1009;
  return TestRecord({id.stage, key, id.mission});
}

// Flies what is missing, of one part of `parts`.
void Fly(const std::string& dir, const sweep::SweepPlan& plan, int part = 0, int parts = 1) {
  const auto store = Open(dir, plan);
  const std::vector<sweep::RunId> stored = store->Stored();
  for (const sweep::RunId& id : AllMissions(LayoutOf(plan)))
    if (LayoutOf(plan).LinearIndex(id) % parts == part &&
        !std::binary_search(stored.begin(), stored.end(), id))
      store->Put(id, RecordOf(plan, id), 0.25);
  store->Commit();
}

void PutNetwork(const std::string& dir, const sweep::SweepPlan& plan, const std::string& sha256) {
  Open(dir, plan)->PutNetworks(
      {.files = {{sha256, {"a network", "bytes"}}}, .uses = {{2, 0, 0, "rc", sha256}}});
}

class GrowthTest : public ::testing::Test {
 protected:
  std::string Dir() const { return temp_ / "run"; }
  std::string Fresh(const sweep::SweepPlan& plan) const {
    Fly(temp_ / "fresh", plan);
    return DigestOfDir(temp_ / "fresh");
  }
  // The error of opening it with this plan, which changes nothing.
  std::string Refused(const sweep::SweepPlan& plan) const {
    const std::string before = ReadPlan(), digest = DigestOfDir(Dir());
    const std::string error = UserErrorOf([&] { Open(Dir(), plan); });
    EXPECT_EQ(ReadPlan(), before);
    EXPECT_EQ(DigestOfDir(Dir()), digest);
    return error.substr(error.find(": holds ") + 2);
  }
  std::string ReadPlan() const { return ResultReader(Dir()).StoredRecipe().plan_text; }

  TempDir temp_;
};

TEST_F(GrowthTest, MoreMissionsAreARunOfThatManyFromTheStart) {
  Fly(Dir(), Masses({1, 2}, 10));
  const sweep::SweepPlan more = Masses({1, 2}, 20);
  {
    const auto store = Open(Dir(), more);
    EXPECT_EQ(store->Grown(), "stage online: 20 missions per arm for 10");
    EXPECT_EQ(store->Stored().size(), 20u);
    EXPECT_TRUE(store->FindDamage().empty());
  }
  Fly(Dir(), more);
  EXPECT_EQ(Open(Dir(), more)->Grown(), "");
  EXPECT_EQ(DigestOfDir(Dir()), Fresh(more));
}

// A run may be refused after it was opened, or killed: until something is put, the plan of before still flies it.
TEST_F(GrowthTest, ThePlanGrowsWithWhatIsPutFirst) {
  const sweep::SweepPlan few = Masses({1, 3}, 10), more = Masses({1, 2, 3}, 12);
  Fly(Dir(), few);
  const std::string before = ReadPlan(), digest = DigestOfDir(Dir());
  {
    const auto store = Open(Dir(), more);
    EXPECT_EQ(store->Stored().back(), (sweep::RunId{0, 2, 9})) << "of the plan that it will have";
    EXPECT_TRUE(store->FindDamage().empty());
    store->PutNote("a note", "changes no plan");
    store->Commit();
    EXPECT_FALSE(store->HasGrown());
    EXPECT_EQ(ReadPlan(), before);
    store->Put({0, 1, 11}, RecordOf(more, {0, 1, 11}), 0.25);
    EXPECT_EQ(ReadPlan(), before) << "a reader beside it";
    EXPECT_EQ(DigestOfDir(Dir()), digest);
  }  // not committed, as after a kill
  EXPECT_EQ(ReadPlan(), before);
  EXPECT_EQ(DigestOfDir(Dir()), digest);
  EXPECT_EQ(Open(Dir(), few)->Stored().size(), 20u);
  {
    const auto store = Open(Dir(), more);
    store->Put({0, 1, 11}, RecordOf(more, {0, 1, 11}), 0.25);
    store->Commit();
    EXPECT_TRUE(store->HasGrown());
    EXPECT_EQ(store->Stored()[10], (sweep::RunId{0, 1, 11}));
    EXPECT_TRUE(store->FindDamage().empty());
  }
  EXPECT_EQ(ReadPlan(), more.CanonicalText());
  Fly(Dir(), more);
  EXPECT_EQ(DigestOfDir(Dir()), Fresh(more));
}

TEST_F(GrowthTest, AFailureAndNetworksGrowThePlanToo) {
  const sweep::SweepPlan few = Learning({"warmup"}, 10, 8);
  sweep::SweepPlan more = Learning({"warmup"}, 10, 8);
  more.stages[2].arms.insert(more.stages[2].arms.begin(), ArmOf("rbs", "rbs"));
  for (const bool networks : {false, true}) {
    const TempDir temp;
    Fly(temp / "run", few);
    PutNetwork(temp / "run", few, "00ff");
    const auto store = Open(temp / "run", more);
    const FlownNetworks there = store->Networks();
    ASSERT_EQ(there.uses.size(), 1u);
    EXPECT_EQ(there.uses[0].arm, 1) << "of the plan that it will have";
    EXPECT_FALSE(store->HasGrown());
    if (networks) {
      store->PutNetworks(there);
    } else {
      store->PutFailure({2, 0, 3}, {"exception", "broken"});
      store->Commit();
    }
    EXPECT_TRUE(store->HasGrown());
    EXPECT_EQ(ResultReader(temp / "run").Networks().uses[0].arm, 1);
    EXPECT_EQ(ResultReader(temp / "run").StoredRecipe().plan_text, more.CanonicalText());
  }
}

// The file is sealed again as it grows: what did not match its seal before still does not.
TEST_F(GrowthTest, NetworksOfAnotherNameAreDamageStill) {
  const sweep::SweepPlan few = Learning({"warmup"}, 10, 8), more = Learning({"warmup"}, 10, 12);
  Fly(Dir(), few);
  PutNetwork(Dir(), few, "aaaa");
  Connection(ResultsIn(Dir()), Connection::Access::kReadWrite)
      .Execute("UPDATE networks SET name = 'another network'");
  Fly(Dir(), more);
  EXPECT_EQ(ReadPlan(), more.CanonicalText());
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(Dir()).Networks(); }), "the names of its networks"));
  PutNetwork(Dir(), more, "aaaa");
  EXPECT_EQ(ResultReader(Dir()).Networks().files.at("aaaa").name, "a network");
}

TEST_F(GrowthTest, ARefusedMergeGrowsNothing) {
  const sweep::SweepPlan few = Masses({1, 3}, 10), more = Masses({1, 2, 3}, 12);
  Fly(Dir(), few);
  Fly(temp_ / "more", more);
  const std::string before = ReadPlan(), digest = DigestOfDir(Dir()), whole = DigestOfDir(temp_ / "more");
  std::filesystem::copy(temp_ / "more", temp_ / "damaged");
  Connection(ResultsIn(temp_ / "damaged"), Connection::Access::kReadWrite)
      .Execute("UPDATE missions SET total_j = 1 WHERE run = 2 AND mission = 11");
  EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(Dir(), {temp_ / "damaged"}); }), "is damaged"));
  EXPECT_EQ(ReadPlan(), before);
  EXPECT_EQ(DigestOfDir(Dir()), digest);
  EXPECT_EQ(Open(Dir(), few)->Grown(), "");
  MergeStores(Dir(), {temp_ / "more"});
  EXPECT_EQ(DigestOfDir(Dir()), whole);
}

// What is refused stays as it was: the plan of before still flies it.
TEST_F(GrowthTest, ADamagedRunDoesNotGrow) {
  const sweep::SweepPlan few = Masses({1, 3}, 10), more = Masses({1, 2, 3}, 12);
  for (const char* change :
       {"UPDATE missions SET total_j = 1 WHERE run = 0 AND mission = 3",
        "INSERT INTO timings VALUES (-2, 3, 1, 1.0)", "INSERT INTO timings VALUES (2, 3, 1, 1.0)"}) {
    SCOPED_TRACE(change);
    const TempDir temp;
    const std::string dir = temp / "run";
    Fly(dir, few);
    {
      Connection database(ResultsIn(dir), Connection::Access::kReadWrite);
      database.Execute(change);
    }
    EXPECT_TRUE(Contains(UserErrorOf([&] { Open(dir, more); }), "is damaged"));
    const Taking only_what_is_there{.repair = Repair::kYes, .may_grow = false};
    EXPECT_TRUE(Contains(
        UserErrorOf([&] { ResultStore::Open(dir, RecipeOf(more), LayoutOf(more), only_what_is_there); }),
        "the plan asks for more than is there (stage"));
    EXPECT_EQ(ResultReader(dir).FindDamage().size(), 1u) << "what is refused has repaired nothing";
    EXPECT_EQ(ResultReader(dir).Layout().stages[0].missions, 10);
    {
      const auto store = ResultStore::Open(dir, RecipeOf(more), LayoutOf(more), {.repair = Repair::kYes});
      EXPECT_EQ(store->Repaired().size(), 1u);
      EXPECT_TRUE(store->FindDamage().empty());
    }
    Fly(dir, more);
    EXPECT_EQ(DigestOfDir(dir), Fresh(more));
  }
}

TEST_F(GrowthTest, AValueMoreOnAnAxisMovesTheArmsBehindIt) {
  const sweep::SweepPlan few = Masses({1, 3}, 10), more = Masses({0.5, 1, 2, 3}, 12);
  Fly(Dir(), few);
  const sweep::SweepPlan mixed = Masses({3, 1}, 10);
  {
    const auto store = Open(Dir(), mixed);
    EXPECT_EQ(store->Grown(), "its arms in another order");
    store->Grow();
    EXPECT_TRUE(store->FindDamage().empty());
  }
  {
    const auto store = Open(Dir(), more);
    EXPECT_EQ(
        store->Grown(),
        "stage online: 12 missions per arm for 10; stage online: arms added: rbs,mass_kg=0.5, rbs,mass_kg=2");
    EXPECT_EQ(store->Stored().front(), (sweep::RunId{0, 1, 0}));
    store->Grow();
    EXPECT_EQ(store->Stored().front(), (sweep::RunId{0, 1, 0}));
  }
  ResultReader reader(Dir());
  EXPECT_EQ(reader.Status()[1].done, 10);
  EXPECT_EQ(reader.Status()[3].wall_s, 10 * 0.25) << "timings move along";
  EXPECT_EQ(reader.LoadMission({0, 3, 4}).record.total_j, RecordOf(few, {0, 1, 4}).total_j);
  Fly(Dir(), more);
  EXPECT_EQ(DigestOfDir(Dir()), Fresh(more));
}

// Arms have other numbers then: what an open reader has read of the plan is no longer true.
TEST_F(GrowthTest, AnOpenReaderIsToldThatThePlanHasGrown) {
  Fly(Dir(), Masses({1.8, 2.4}, 4));
  ResultReader reader(Dir());
  EXPECT_EQ(reader.Status().size(), 2u);
  Fly(Dir(), Masses({1.8, 2.1, 2.4}, 4));
  const std::string grown =
      Dir() + ": its plan has grown since it was opened; open it again (the same command does)";
  EXPECT_EQ(UserErrorOf([&] { reader.Status(); }), grown);
  EXPECT_EQ(UserErrorOf([&] { reader.Stored(); }), grown);
  EXPECT_EQ(UserErrorOf([&] { reader.CheckWhole(); }), grown);
  EXPECT_EQ(UserErrorOf([&] { reader.FindDamage(); }), grown);
  EXPECT_EQ(UserErrorOf([&] { reader.LoadMission({0, 1, 0}); }), grown);
  EXPECT_EQ(ResultReader(Dir()).Status().size(), 3u);
}

TEST_F(GrowthTest, WhatHasFailedIsStillTheSameMissions) {
  const sweep::SweepPlan plan = Masses({1, 3}, 10);
  {
    const auto store = Open(Dir(), plan);
    store->PutFailure({0, 1, 3}, {"exception", "broken"});
    store->Commit();
  }
  EXPECT_EQ(Open(Dir(), Masses({1, 2, 3}, 10))->Failed(), (std::vector<sweep::RunId>{{0, 2, 3}}));
  Grow(Dir(), Masses({1, 2, 3}, 10));
  const std::vector<FailedMission> failures = ResultReader(Dir()).Failures();
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_EQ(failures[0].id, (sweep::RunId{0, 2, 3}));
}

TEST_F(GrowthTest, WhatWouldChangeStoredMissionsIsRefusedWithTheDifference) {
  Fly(Dir(), Masses({1, 2}, 10));
  const std::string head = "holds results of another recipe: ",
                    tail = "; give another --out, or remove that folder";
  EXPECT_EQ(Refused(Masses({1, 2}, 9)),
            head + "stage online has 10 missions per arm there and 9 here, and none is taken out" + tail);
  EXPECT_EQ(Refused(Masses({1, 3}, 10)),
            head + "stage online: arm rbs,mass_kg=2 is there, but not here" + tail);
  sweep::SweepPlan other = Masses({1, 2, 3}, 20);
  other.seed = 8;
  EXPECT_EQ(Refused(other), head + "the seed is 7 there and 8 here" + tail);
  other = Masses({1, 2, 3}, 20);
  other.stages[0].arms[1].config.robot.speed_mps = 6;
  EXPECT_EQ(Refused(other), head + "arm rbs,mass_kg=2: robot.speed_mps is 5 there and 6 here" + tail);
  other = Masses({1, 2, 3}, 20);
  other.stages[0].arms[0].config.mission.first_scenario = 100;
  EXPECT_EQ(Refused(other),
            head + "arm rbs,mass_kg=1: mission.first_scenario is 0 there and 100 here" + tail);
  other = Masses({1, 2}, 20);
  other.stages[0].precision = sweep::Precision{"msr_pct", 2, 140};
  EXPECT_EQ(Refused(other), head + "stage online has another precision there than here" + tail);
}

TEST_F(GrowthTest, OtherCodeOrAnotherWorldIsNotGrowth) {
  const sweep::SweepPlan few = Masses({1}, 10), more = Masses({1}, 20);
  Fly(Dir(), few);
  Recipe recipe = RecipeOf(more);
  recipe.code["flight"] = {"ffff"};
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(Dir(), recipe, LayoutOf(more)); }),
                       "the code of flight is 0123abcd there and ffff here"));
  recipe = RecipeOf(more);
  recipe.inputs = {{"worlds/ridges.yaml", "fingerprint-2"}};
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(Dir(), recipe, LayoutOf(more)); }),
                       "worlds/ridges.yaml is fingerprint-1 there and fingerprint-2 here"));
  EXPECT_EQ(ReadPlan(), few.CanonicalText());
  recipe = RecipeOf(more);
  recipe.inputs["worlds/mine.yaml"] = "fingerprint-3";
  recipe.files = {{"mine.yaml", "sha", std::nullopt}};
  recipe.places = {{"worlds/mine.yaml", "mine.yaml"}};
  recipe.code["pixels"] = {"89ab"};
  ResultStore::Open(Dir(), recipe, LayoutOf(more))->Grow();
  const Recipe grown = ResultReader(Dir()).StoredRecipe();
  EXPECT_EQ(grown.inputs, recipe.inputs);
  EXPECT_EQ(grown.places, recipe.places);
  EXPECT_EQ(grown.code, recipe.code);
}

TEST_F(GrowthTest, AWarmUpThatNetworksHaveLearnedFromStaysAsItIs) {
  const sweep::SweepPlan plan = Learning({"warmup"}, 10, 8);
  Fly(Dir(), plan);
  PutNetwork(Dir(), plan, "00ff");
  EXPECT_TRUE(Contains(
      Refused(Learning({"warmup"}, 12, 8)),
      "stage warmup has 10 missions per arm there and 12 here, and the networks of stage online have "
      "learned from them"));
  EXPECT_TRUE(Contains(Refused(Learning({"another", "warmup"}, 10, 8)),
                       "the networks of stage online have learned from warmup/warmup there and would from "
                       "warmup/another here"));
  EXPECT_EQ(Grow(Dir(), Learning({"warmup", "another"}, 10, 8)), "stage warmup: arms added: another");
  const sweep::SweepPlan more = Learning({"warmup", "another"}, 10, 16);
  EXPECT_EQ(Grow(Dir(), more), "stage online: 16 missions per arm for 8");
  const FlownNetworks networks = ResultReader(Dir()).Networks();
  ASSERT_EQ(networks.uses.size(), 1u);
  EXPECT_EQ(networks.uses[0].stage, 2);
  Fly(Dir(), more);
  EXPECT_EQ(DigestOfDir(Dir()), Fresh(more));
}

TEST_F(GrowthTest, AWarmUpThatNobodyHasLearnedFromMayGrow) {
  Fly(Dir(), Learning({"warmup"}, 10, 8));
  EXPECT_EQ(Open(Dir(), Learning({"warmup"}, 12, 8))->Grown(), "stage warmup: 12 missions per arm for 10");
}

TEST_F(GrowthTest, WhatGrowsWhileItIsMergedIsRefused) {
  Fly(Dir(), Masses({1, 3}, 10));
  std::vector<std::unique_ptr<ResultReader>> readers;
  readers.push_back(std::make_unique<ResultReader>(Dir()));
  Fly(Dir(), Masses({1, 2, 3}, 10));
  EXPECT_TRUE(Contains(UserErrorOf([&] { JoinedMissions(readers, 1); }), "its plan has grown meanwhile"));
}

TEST_F(GrowthTest, ShardsGrowOneByOneAndMergeIntoTheRunOfBefore) {
  const sweep::SweepPlan few = Masses({1, 3}, 10), more = Masses({1, 2, 3}, 15);
  for (int part = 0; part < 2; ++part) Fly(temp_ / fmt::format("part{}", part), few, part, 2);
  const std::vector<std::string> parts = {temp_ / "part0", temp_ / "part1"};
  MergeStores(Dir(), parts);
  Fly(parts[0], more, 0, 2);
  const auto missions = [](const std::string& dir) { return ResultReader(dir).CountMissions(); };
  const std::int64_t before = missions(Dir()), grown = missions(parts[0]);
  for (int again = 0; again < 2; ++again) {  // in either order, into a run of before and of after
    MergeStores(Dir(), again == 0 ? parts : std::vector<std::string>{parts[1], parts[0]});
    EXPECT_EQ(ResultReader(Dir()).Layout().Missions(), 3 * 15);
    EXPECT_EQ(missions(Dir()), before + grown - before / 2);
    EXPECT_TRUE(ResultReader(Dir()).FindDamage().empty());
  }
  MergeStores(temp_ / "other", {parts[1], parts[0]});
  EXPECT_EQ(DigestOfDir(temp_ / "other"), DigestOfDir(Dir()));
  Fly(parts[1], more, 1, 2);
  MergeStores(Dir(), parts);
  EXPECT_EQ(DigestOfDir(Dir()), Fresh(more));
}

}  // namespace
}  // namespace ed3r::store
