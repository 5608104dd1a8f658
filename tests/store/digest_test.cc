#include "engine/store/digest.h"

#include <algorithm>
#include <functional>
#include <set>

#include "engine/core/sha256.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

std::string DigestOfRun(const std::vector<sweep::RunId>& order, std::size_t group, const Recipe& recipe,
                        double wall_s) {
  const TempDir temp;
  {
    const auto store = ResultStore::Open(temp / "run", recipe, TestLayout());
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i % 7 == 0) store->PutFailure(order[i], {"exception", "tried once"});
      store->Put(order[i], TestRecord(order[i]), wall_s);
      if (i % group == group - 1) store->Commit();
    }
    store->Commit();
  }
  return DigestOfDir(temp / "run");
}

TEST(DigestTest, DependsOnResultsAlone) {
  std::vector<sweep::RunId> order = AllMissions(TestLayout());
  const std::string digest = DigestOfRun(order, order.size(), TestRecipe(), 1.0);
  EXPECT_EQ(DigestOfRun(order, 1, TestRecipe(), 1.0), digest) << "groups";
  EXPECT_EQ(DigestOfRun(order, 13, TestRecipe(), 2.0), digest) << "wall time";
  std::reverse(order.begin(), order.end());
  EXPECT_EQ(DigestOfRun(order, 13, TestRecipe(), 1.0), digest) << "order";
  Recipe elsewhere = TestRecipe();
  elsewhere.notes = {{"simd", "scalar"}};
  elsewhere.code = {{"flight", {"another commit that flies the same"}}};
  EXPECT_EQ(DigestOfRun(order, 13, elsewhere, 1.0), digest) << "machine and code";
  order.pop_back();
  EXPECT_NE(DigestOfRun(order, 13, TestRecipe(), 1.0), digest) << "a mission is missing";
}

// Changes each column of a record in turn; every change must be seen.
template <class Record>
void ExpectEveryColumnCounts(const std::function<std::string(const std::function<void(Record&)>&)>& digest) {
  std::set<std::string> digests = {digest([](Record&) {})};
  int columns = 0;
  Record probe;
  Record::Describe(probe, [&](std::string_view, auto&) { ++columns; });
  for (int changed = 0; changed < columns; ++changed) {
    const std::string other = digest([changed](Record& record) {
      int column = 0;
      Record::Describe(record, [&](std::string_view, auto& field) {
        if (column++ == changed) field += 1;
      });
    });
    EXPECT_TRUE(digests.insert(other).second) << "column " << changed;
  }
  EXPECT_EQ(digests.size(), static_cast<std::size_t>(columns) + 1);
}

TEST(DigestTest, EveryColumnCounts) {
  ExpectEveryColumnCounts<mission::MissionRecord>([](const auto& change) {
    mission::MissionRecord record = TestRecord({0, 0, 1});
    change(record);
    return DigestOf(record);
  });
  ExpectEveryColumnCounts<mission::TimestepRecord>([](const auto& change) {
    mission::MissionRecord record;
    record.steps.resize(2);
    change(record.steps[1]);
    return DigestOf(record);
  });
}

TEST(DigestTest, StageArmAndMissionCount) {
  std::set<std::string> digests;
  const mission::MissionRecord record = TestRecord({0, 0, 0});
  const std::vector<sweep::RunId> places = {{0, 0, 0}, {0, 0, 1}, {2, 0, 0}, {2, 1, 0}};
  for (const sweep::RunId& id : places) {
    const TempDir temp;
    ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->Put(id, record, 0);
    const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
    store->Put(id, record, 0);
    store->Commit();
    digests.insert(DigestOfDir(temp / "run"));
  }
  EXPECT_EQ(digests.size(), places.size());
}

// The format, spelt out: whoever reads it from the documentation gets the same value.
TEST(DigestTest, IsTheDocumentedFormat) {
  const TempDir temp;
  WriteStore(temp / "run", {{2, 1, 4}});
  const auto number = [](std::int64_t value) {
    std::string bytes;
    for (int i = 0; i < 8; ++i)
      bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
    return bytes;
  };
  const auto text = [&](const std::string& s) { return number(static_cast<std::int64_t>(s.size())) + s; };
  const auto names = [](auto record) {
    std::string all;
    decltype(record)::Describe(
        record, [&](std::string_view name, auto&) { all += (all.empty() ? "" : ", ") + std::string(name); });
    return all;
  };
  const auto values = [&](const auto& record) {
    std::string all;
    std::remove_cvref_t<decltype(record)>::Describe(record, [&](std::string_view, const auto& field) {
      all += number(std::bit_cast<std::int64_t>(field));
    });
    return all;
  };
  const auto sha256 = [](const std::string& bytes) {
    Sha256 sha;
    sha.Update(bytes);
    return sha.Hex();
  };
  const mission::MissionRecord record = TestRecord({2, 1, 4});
  std::string steps =
      text(names(mission::TimestepRecord{})) + number(static_cast<std::int64_t>(record.steps.size()));
  for (const mission::TimestepRecord& step : record.steps) steps += values(step);
  const std::string mission = text("online") + text("ed3r-75") + number(4) +
                              text(names(mission::MissionRecord{})) + values(record) + text(sha256(steps));
  EXPECT_EQ(DigestOfDir(temp / "run"), sha256(text("ed3r results 2") + sha256(mission)));
  EXPECT_GT(record.steps.size(), 0u);
}

}  // namespace
}  // namespace ed3r::store
