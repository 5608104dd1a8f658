#include "engine/store/difference.h"

#include <functional>

#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

class DifferenceTest : public ::testing::Test {
 protected:
  // Two runs with every third mission; `change` alters what the second puts, or leaves it out.
  RunDifference Diff(const std::function<bool(const sweep::RunId&, mission::MissionRecord&)>& change) {
    const std::string a = temp_ / fmt::format("a{}", ++pairs_), b = temp_ / fmt::format("b{}", pairs_);
    const auto first = ResultStore::Open(a, TestRecipe(), TestLayout());
    const auto second = ResultStore::Open(b, TestRecipe(), TestLayout());
    const std::vector<sweep::RunId> all = AllMissions(TestLayout());
    for (std::size_t i = 0; i < all.size(); i += 3) {
      mission::MissionRecord record = Long(all[i]);
      first->Put(all[i], record, 0);
      if (change(all[i], record)) second->Put(all[i], record, 0);
    }
    first->Commit();
    second->Commit();
    ResultReader here(a), there(b);
    return DiffRuns(here, there);
  }

  static mission::MissionRecord Long(const sweep::RunId& id) {
    mission::MissionRecord record = TestRecord(id);
    record.steps.resize(5);
    for (int k = 1; k <= 5; ++k) record.steps[static_cast<std::size_t>(k - 1)].k = k;
    return record;
  }

  TempDir temp_;
  int pairs_ = 0;
};

TEST_F(DifferenceTest, NothingDiffers) {
  const RunDifference difference = Diff([](const sweep::RunId&, mission::MissionRecord&) { return true; });
  EXPECT_FALSE(difference.first);
  EXPECT_EQ(difference.compared, 34);
  EXPECT_EQ(difference.differing, 0);
}

TEST_F(DifferenceTest, TheFirstTimestepAndQuantityAreNamed) {
  const RunDifference difference = Diff([](const sweep::RunId& id, mission::MissionRecord& record) {
    if (id.stage == 2) {
      record.total_j = 12.5;
      record.steps[3].scs = 0.25;
      record.steps[3].x_m = 1.5;
      record.steps[4].k = 9;
    }
    return true;
  });
  ASSERT_TRUE(difference.first);
  EXPECT_EQ(difference.first->mission, "stage online, arm rbs, mission 2");
  EXPECT_EQ(difference.first->timestep, 4);
  EXPECT_EQ(difference.first->quantity, "x_m");
  EXPECT_EQ(difference.first->there, "1.5");
  EXPECT_EQ(difference.differing, 20);
}

TEST_F(DifferenceTest, OfTheRecordAloneWhereTimestepsAgree) {
  const RunDifference difference = Diff([](const sweep::RunId& id, mission::MissionRecord& record) {
    if (id.stage == 0 && id.mission == 6) record.halts += 1;
    return true;
  });
  ASSERT_TRUE(difference.first);
  EXPECT_EQ(difference.first->mission, "stage warmup, arm warmup, mission 6");
  EXPECT_EQ(difference.first->timestep, 0);
  EXPECT_EQ(difference.first->quantity, "halts");
  EXPECT_EQ(difference.differing, 1);
}

TEST_F(DifferenceTest, AShorterMissionAndAMissingOne) {
  const RunDifference shorter = Diff([](const sweep::RunId& id, mission::MissionRecord& record) {
    if (id.mission == 9) record.steps.pop_back();
    return true;
  });
  ASSERT_TRUE(shorter.first);
  EXPECT_EQ(shorter.first->timestep, 5);
  EXPECT_EQ(shorter.first->quantity, "timestep");
  EXPECT_EQ(shorter.first->here, "flown");
  const RunDifference missing =
      Diff([](const sweep::RunId& id, mission::MissionRecord&) { return id.mission != 9; });
  ASSERT_TRUE(missing.first);
  EXPECT_EQ(missing.first->mission, "stage warmup, arm warmup, mission 9");
  EXPECT_EQ(missing.first->quantity, "mission");
  EXPECT_EQ(missing.only_here, 1);
  EXPECT_EQ(missing.differing, 0);
}

// Two runs are not identical where one has an arm more.
TEST_F(DifferenceTest, ArmsThatOneRunLacksAreCounted) {
  RunLayout fewer = TestLayout();
  fewer.stages[2].arms.erase(fewer.stages[2].arms.begin());
  WriteStore(temp_ / "more", {{0, 0, 1}, {2, 0, 3}, {2, 0, 4}, {2, 1, 5}});
  {
    const auto store = ResultStore::Open(temp_ / "less", TestRecipe(), fewer);
    store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0);
    mission::MissionRecord other = TestRecord({2, 1, 5});
    other.total_j += 1;
    store->Put({2, 0, 5}, other, 0);
    store->Commit();
  }
  ResultReader more(temp_ / "more"), less(temp_ / "less");
  const RunDifference difference = DiffRuns(more, less), reverse = DiffRuns(less, more);
  EXPECT_EQ(difference.compared, 2);
  EXPECT_EQ(difference.only_here, 2);
  EXPECT_EQ(difference.only_there, 0);
  ASSERT_TRUE(difference.first);
  EXPECT_EQ(difference.first->quantity, "total_j") << "a number that differs comes first";
  EXPECT_EQ(reverse.only_here, 0);
  EXPECT_EQ(reverse.only_there, 2);
}

}  // namespace
}  // namespace ed3r::store
