#include "engine/schedule/todo.h"

#include <algorithm>
#include <set>

#include "tests/store/store_fixture.h"

namespace ed3r::schedule {
namespace {

TEST(ShardTest, IsReadStrictly) {
  EXPECT_EQ(ParseShard("1/4").index, 1);
  EXPECT_EQ(ParseShard("1/4").count, 4);
  EXPECT_EQ(ParseShard("4/4").index, 0) << "counted from 1, the last is the first counted from 0";
  EXPECT_EQ(ParseShard("0/1").count, 1);
  for (const char* wrong : {"", "1", "/", "1/", "/4", "5/4", "-1/4", "1/0", "0/0", "1/-4", "1/4/2", "a/4",
                            "1 /4", "1/4 ", "0x1/4", "1.0/4", "99999999999999999999/4"})
    EXPECT_TRUE(store::Contains(store::UserErrorOf([&] { ParseShard(wrong); }),
                                fmt::format("--shard: \"{}\"", wrong)));
}

TEST(ShardTest, EveryMissionIsInExactlyOneShard) {
  const store::RunLayout layout = store::TestLayout();
  for (const std::int64_t count : {1, 2, 3, 7, 100, 150}) {
    std::vector<sweep::RunId> together;
    std::size_t smallest = 1000, largest = 0;
    for (std::int64_t index = 0; index < count; ++index) {
      std::size_t size = 0;
      for (int stage = 0; stage < 3; ++stage) {
        for (const sweep::RunId& id : Todo(layout, stage, {index, count}, {})) {
          together.push_back(id);
          ++size;
        }
      }
      smallest = std::min(smallest, size);
      largest = std::max(largest, size);
    }
    std::sort(together.begin(), together.end());
    EXPECT_EQ(together, store::AllMissions(layout)) << count;
    EXPECT_LE(largest - smallest, 1u);
  }
}

// Sites recur at a fixed distance, and where a site is far away missions are long.
TEST(ShardTest, EachGetsEverySiteWhateverTheirNumber) {
  constexpr std::int64_t kSites = 28, kMissions = 28 * 28 * 64;
  for (const std::int64_t count : {2, 7, 14, 16, 28, 56}) {
    std::vector<std::vector<int>> missions(static_cast<std::size_t>(count), std::vector<int>(kSites));
    for (std::int64_t i = 0; i < kMissions; ++i)
      ++missions[static_cast<std::size_t>(ShardOf(i, count))][static_cast<std::size_t>(i % kSites)];
    const double expected = 1.0 * kMissions / static_cast<double>(count * kSites);
    for (const std::vector<int>& by_site : missions)
      for (const int of_site : by_site) EXPECT_NEAR(of_site, expected, expected / 4) << count << " shards";
  }
}

TEST(TodoTest, LeavesOutWhatIsStored) {
  const store::RunLayout layout = store::TestLayout();
  const std::vector<sweep::RunId> stored = {{0, 0, 0}, {0, 0, 39}, {2, 0, 1}, {2, 1, 2}};
  const std::vector<sweep::RunId> todo = Todo(layout, 2, Shard{}, stored);
  EXPECT_EQ(todo.size(), 58u);
  for (const sweep::RunId& id : stored) EXPECT_EQ(std::count(todo.begin(), todo.end(), id), 0);
  EXPECT_TRUE(std::is_sorted(todo.begin(), todo.end()));
  EXPECT_TRUE(Todo(layout, 1, Shard{}, stored).empty());
}

TEST(TodoTest, ArrangesWithoutLoss) {
  const std::vector<sweep::RunId> all = store::AllMissions(store::TestLayout());
  EXPECT_EQ(Arrange(all, Order::kNatural), all);
  std::vector<sweep::RunId> reversed = Arrange(all, Order::kReversed);
  EXPECT_EQ(reversed.front(), all.back());
  std::vector<sweep::RunId> shuffled = Arrange(all, Order::kShuffled, 1);
  EXPECT_EQ(shuffled, Arrange(all, Order::kShuffled, 1));
  EXPECT_NE(shuffled, Arrange(all, Order::kShuffled, 2));
  EXPECT_NE(shuffled, all);
  for (std::vector<sweep::RunId>* order : {&reversed, &shuffled}) {
    std::sort(order->begin(), order->end());
    EXPECT_EQ(*order, all);
  }
}

}  // namespace
}  // namespace ed3r::schedule
