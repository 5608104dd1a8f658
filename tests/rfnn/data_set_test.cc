#include "engine/rfnn/data_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "engine/core/check.h"
#include "tests/rfnn/toys.h"

namespace ed3r::rfnn {
namespace {

using ::ed3r::testing::MessageOf;
using ::ed3r::testing::ToyData;

std::set<std::int64_t> MissionsOf(const DataSet& data, const std::vector<std::uint32_t>& rows) {
  std::set<std::int64_t> missions;
  for (const std::uint32_t r : rows) missions.insert(data.missions[r]);
  return missions;
}

// Missions of unequal length, their rows interleaved.
DataSet Uneven(int missions) {
  DataSet data(1);
  for (int k = 0; k < 40; ++k)
    for (int m = 0; m < missions; ++m)
      if (k < 5 + m % 36) {
        const float row[] = {static_cast<float>(k)};
        data.Add(row, static_cast<float>(m), 1000 - m);
      }
  return data;
}

TEST(SplitTest, NoMissionHasRowsInTwoParts) {
  const DataSet data = Uneven(97);
  const Split split = MakeSplit(data.missions, 5);
  std::set<std::int64_t> seen;
  std::vector<std::uint32_t> all;
  for (const auto* part : {&split.train, &split.validation, &split.test}) {
    for (const std::int64_t mission : MissionsOf(data, *part)) EXPECT_TRUE(seen.insert(mission).second);
    EXPECT_TRUE(std::is_sorted(part->begin(), part->end()));
    all.insert(all.end(), part->begin(), part->end());
  }
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), data.rows());
  for (std::size_t r = 0; r < all.size(); ++r) ASSERT_EQ(all[r], r);
}

TEST(SplitTest, SharesAreThePapers) {
  DataSet data(1);
  const float row[] = {0.0f};
  for (int m = 0; m < 2040; ++m) data.Add(row, 0.0f, m);
  const Split split = MakeSplit(data.missions, 1);
  EXPECT_EQ(split.train.size(), 1734u);
  EXPECT_EQ(split.validation.size(), 204u);
  EXPECT_EQ(split.test.size(), 102u);
}

TEST(SplitTest, IsDrawnByItsSeedAndByTheMissionsOnly) {
  const DataSet data = Uneven(60);
  const Split split = MakeSplit(data.missions, 1);
  EXPECT_EQ(MakeSplit(data.missions, 1).test, split.test);
  EXPECT_NE(MissionsOf(data, MakeSplit(data.missions, 2).test), MissionsOf(data, split.test));
  DataSet reversed = data;
  std::reverse(reversed.missions.begin(), reversed.missions.end());
  EXPECT_EQ(MissionsOf(reversed, MakeSplit(reversed.missions, 1).test), MissionsOf(data, split.test));
  EXPECT_EQ(MissionsOf(reversed, MakeSplit(reversed.missions, 1).validation),
            MissionsOf(data, split.validation));
}

TEST(SplitTest, ThreeMissionsAreTheLeast) {
  const std::vector<std::int64_t> three = {4, 4, 8, 15, 15};
  const Split split = MakeSplit(three, 3);
  EXPECT_FALSE(split.train.empty());
  EXPECT_FALSE(split.validation.empty());
  EXPECT_FALSE(split.test.empty());
  const std::vector<std::int64_t> two = {4, 4, 8};
  EXPECT_EQ(
      testing::MessageOf<UserError>([&] { MakeSplit(two, 3); }),
      "training: the warm-up holds rows of 2 missions; at least 3, one each to train, validate and test on");
}

TEST(DataSetTest, RefusesWhatIsNotFiniteOrNotARow) {
  DataSet data(2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float good[] = {1, 2}, bad[] = {1, nan}, narrow[] = {1};
  EXPECT_THROW(data.Add(bad, 0, 0), InternalError);
  EXPECT_THROW(data.Add(good, nan, 0), InternalError);
  EXPECT_THROW(data.Add(narrow, 0, 0), InternalError);
  EXPECT_EQ(data.rows(), 0u);
}

TEST(DataSetTest, FingerprintTellsDataApart) {
  const DataSet data = testing::ToyData(4, 5, 0.1);
  std::set<std::string> prints = {Fingerprint(data)};
  EXPECT_EQ(Fingerprint(DataSet(data)), Fingerprint(data));
  DataSet other = data;
  other.inputs[7] = std::nextafter(other.inputs[7], 0.0f);
  EXPECT_TRUE(prints.insert(Fingerprint(other)).second);
  other = data;
  other.targets[3] += 1.0f;
  EXPECT_TRUE(prints.insert(Fingerprint(other)).second);
  other = data;
  other.missions[19] += 1;
  EXPECT_TRUE(prints.insert(Fingerprint(other)).second);
}

}  // namespace
}  // namespace ed3r::rfnn
