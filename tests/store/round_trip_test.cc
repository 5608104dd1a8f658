// What goes in comes out: every column of both tables, and the values that SQLite treats specially.
#include <bit>
#include <cmath>
#include <limits>

#include "engine/store/columns.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

const sweep::RunId kFirst{0, 0, 0};

mission::MissionRecord ThroughStore(const mission::MissionRecord& record) {
  const TempDir temp;
  {
    const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
    store->Put(kFirst, record, 1.5);
    store->Commit();
  }
  return ResultReader(temp / "run").LoadMission(kFirst).record;
}

std::vector<std::int64_t> Bits(const mission::TimestepRecord& step) {
  std::vector<std::int64_t> bits;
  mission::TimestepRecord::Describe(
      step, [&](std::string_view, const auto& field) { bits.push_back(std::bit_cast<std::int64_t>(field)); });
  return bits;
}

// Stores the values in a real column, one timestep each.
std::vector<double> ThroughStore(const std::vector<double>& values) {
  mission::MissionRecord record;
  for (double value : values) {
    mission::TimestepRecord& step = record.steps.emplace_back();
    step.k = static_cast<std::int64_t>(record.steps.size());
    step.reward = value;
  }
  std::vector<double> back;
  for (const mission::TimestepRecord& step : ThroughStore(record).steps) back.push_back(step.reward);
  return back;
}

TEST(RoundTripTest, EveryColumnKeepsItsPlace) {
  mission::MissionRecord record = TestRecord(kFirst);
  Stream stream(3, 0, Purpose::kScenario);
  for (int k = 1; k <= 20; ++k) {
    FillColumns(stream, record.steps.emplace_back());
    record.steps.back().k = 100 + k;
  }
  const mission::MissionRecord back = ThroughStore(record);
  ASSERT_EQ(back.steps.size(), record.steps.size());
  for (std::size_t i = 0; i < back.steps.size(); ++i) EXPECT_EQ(Bits(back.steps[i]), Bits(record.steps[i]));
  EXPECT_EQ(CanonicalBytes(back), CanonicalBytes(record));
  EXPECT_EQ(back.scenario, record.scenario);
  EXPECT_EQ(back.start_yaw_rad, record.start_yaw_rad);
}

TEST(RoundTripTest, DoublesBitForBit) {
  using Limits = std::numeric_limits<double>;
  std::vector<double> values = {1.0,
                                -1.0,
                                0.1,
                                Limits::infinity(),
                                -Limits::infinity(),
                                Limits::max(),
                                Limits::lowest(),
                                Limits::min(),
                                Limits::denorm_min(),
                                -Limits::denorm_min(),
                                0x1p53,
                                0x1p53 + 2,
                                0x1p62,
                                0x1p63,
                                -0x1p63,
                                0x1p64,
                                1e15,
                                1e300};
  Stream stream(11, 0, Purpose::kScenario);
  while (values.size() < 5000) {  // any bits that are a number
    const auto high = static_cast<std::uint64_t>(stream.Bits());
    const double value = std::bit_cast<double>(high << 32 | stream.Bits());
    if (!std::isnan(value)) values.push_back(value);
  }
  const std::vector<double> back = ThroughStore(values);
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back[i]), std::bit_cast<std::uint64_t>(values[i])) << values[i];
}

TEST(RoundTripTest, NanAndNegativeZeroComeBackCanonical) {
  const double odd_nan = std::bit_cast<double>(0xfff8000000001234ULL);
  const std::vector<double> values = {std::nan(""), odd_nan, -0.0, 0.0};
  const std::vector<double> back = ThroughStore(values);
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back[i]), std::bit_cast<std::uint64_t>(Canonical(values[i]))) << i;
  EXPECT_TRUE(std::isnan(back[0]));
  EXPECT_TRUE(std::isnan(back[1]));
  EXPECT_FALSE(std::signbit(back[2]));
}

TEST(RoundTripTest, IntegerExtremes) {
  mission::MissionRecord record;
  record.scenario = std::numeric_limits<std::int64_t>::max();
  record.site = std::numeric_limits<std::int64_t>::min();
  record.base_station = -1;
  const mission::MissionRecord back = ThroughStore(record);
  EXPECT_EQ(back.scenario, record.scenario);
  EXPECT_EQ(back.site, record.site);
  EXPECT_EQ(back.base_station, record.base_station);
  EXPECT_TRUE(back.steps.empty());
}

// A digest taken in memory (replay) must equal the one of what is stored.
TEST(RoundTripTest, DigestOfARecordOutlivesTheStore) {
  mission::MissionRecord record = TestRecord(kFirst);
  record.steps.resize(3);
  for (std::size_t i = 0; i < 3; ++i) record.steps[i].k = static_cast<std::int64_t>(i) + 1;
  record.distance_m = -0.0;
  record.steps[1].rc_predicted_reward = std::bit_cast<double>(0xfff8000000001234ULL);
  record.steps[2].robot_predicted_reward = std::nan("");
  record.steps[2].x_m = -0.0;
  EXPECT_EQ(DigestOf(ThroughStore(record)), DigestOf(record));
}

TEST(RoundTripTest, TimestepsMustBeNumberedUpwards) {
  const TempDir temp;
  const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
  mission::MissionRecord record;
  record.steps.resize(2);
  record.steps[0].k = 2;
  record.steps[1].k = 2;
  EXPECT_THROW(store->Put(kFirst, record, 0), InternalError);
  // The refused record cost nothing: the store goes on.
  record.steps[1].k = 3;
  store->Put(kFirst, record, 0);
  store->Commit();
  EXPECT_EQ(store->Stored(), std::vector<sweep::RunId>{kFirst});
}

}  // namespace
}  // namespace ed3r::store
