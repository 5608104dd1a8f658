// Files that other versions wrote: each format's own small run (rbs.yaml, three missions) is kept in data/, and is read for
// as long as results of that time are worth reading.
#include <sqlite3.h>

#include "engine/store/checksums.h"
#include "engine/store/shards/merge.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

void Sql(const std::string& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

// A run directory with the sample of a format.
std::string Sample(const TempDir& temp, int format) {
  const std::string dir = temp / fmt::format("format{}", format);
  fs::create_directories(dir);
  fs::copy_file(fmt::format("{}/tests/store/data/format{}.sqlite", ED3R_SOURCE_DIR, format), ResultsIn(dir));
  return dir;
}

void ExpectThreeMissionsOfRbs(const std::string& dir) {
  ResultReader reader(dir);
  EXPECT_EQ(reader.Layout().name, "rbs");
  EXPECT_TRUE(Contains(reader.StoredRecipe().plan_text, "mission.strategy=rbs"));
  EXPECT_EQ(reader.StoredRecipe().inputs.size(), 1u);
  const std::vector<ArmStatus> status = reader.Status();
  ASSERT_EQ(status.size(), 1u);
  EXPECT_EQ(status[0].done, 3);
  EXPECT_EQ(reader.FindDamage().size(), 0u);
  EXPECT_EQ(reader.CheckWhole(), DigestOf(reader));
  std::int64_t timesteps = 0, steps = 0;
  double total_j = 0, steps_j = 0;
  reader.ForEachMission(Steps::kLoad, [&](const StoredMission& mission) {
    timesteps += mission.record.timesteps;
    total_j += mission.record.total_j;
    for (const mission::TimestepRecord& step : mission.record.steps) ++steps, steps_j += step.total_j;
  });
  EXPECT_EQ(steps, timesteps);
  EXPECT_GT(steps, 3);
  EXPECT_NEAR(steps_j, total_j, 1e-9 * total_j);
}

TEST(FormatTest, Format1IsReadWithTheDigestOfItsTime) {
  const TempDir temp;
  const std::string dir = Sample(temp, 1);
  ExpectThreeMissionsOfRbs(dir);
  EXPECT_EQ(DigestOfDir(dir), "f34816e94b587de899414c31b326518fd1d9539528fc2caf90224220761a3678");
  ResultReader reader(dir);
  EXPECT_EQ(reader.Format(), 1);
  EXPECT_EQ(CodeText(reader.StoredRecipe().code), "sources ba3183604684cabe");
  EXPECT_TRUE(reader.Files().empty());
  EXPECT_TRUE(reader.Networks().uses.empty());
  const auto size = fs::file_size(ResultsIn(dir));
  EXPECT_TRUE(Contains(
      UserErrorOf([&] { ResultStore::Open(dir, TestRecipe(), TestLayout()); }),
      "written by an older ed3r (code sources ba3183604684cabe): it can be read, but not continued"));
  EXPECT_EQ(fs::file_size(ResultsIn(dir)), size);
}

// A copy of it would have checksums, over whatever had become of its numbers.
TEST(FormatTest, Format1HasNoChecksumsAndIsNotMerged) {
  const TempDir temp;
  const std::string dir = Sample(temp, 1);
  EXPECT_FALSE(ResultReader(dir).Tables().checked());
  EXPECT_TRUE(Contains(
      UserErrorOf([&] { MergeStores(temp / "merged", {dir}); }),
      "without checksums (format 1): nothing of it can be compared: it can be read, but not merged"));
  EXPECT_FALSE(fs::exists(temp / "merged"));
  EXPECT_TRUE(ResultReader(Sample(temp, 2)).Tables().checked());
}

TEST(FormatTest, AFileThatOnlySaysThatItIsOfFormat1IsRefused) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  Sql(ResultsIn(temp / "run"), "PRAGMA user_version = 1");
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader reader(temp / "run"); }),
                       "it says that it is of format 1, which has none"));
}

TEST(FormatTest, Format2IsReadWithTheDigestOfItsTime) {
  const TempDir temp;
  const std::string dir = Sample(temp, 2);
  ExpectThreeMissionsOfRbs(dir);
  EXPECT_EQ(DigestOfDir(dir), "159932b1c42bad6d2c02713a79e5f492591a80acb03a53f2bc08b5c09cb3357a");
  ResultReader reader(dir);
  EXPECT_EQ(reader.Format(), 2);
  ASSERT_EQ(reader.Files().size(), 1u);
  EXPECT_EQ(reader.Files()[0].name, "ridges.yaml");
}

// As a file of before a column was added: made by taking one out of a present one.
TEST(FormatTest, AColumnThatTheFileLacksHasItsInitialValue) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}, {2, 1, 3}});
  Sql(ResultsIn(temp / "run"),
      "DROP VIEW named_timesteps; DROP VIEW named_missions; ALTER TABLE timesteps DROP COLUMN rate_bps; "
      "ALTER TABLE missions DROP COLUMN seal; "
      "ALTER TABLE missions DROP COLUMN network");
  {
    Connection database(ResultsIn(temp / "run"), Connection::Access::kReadWrite);
    database.Execute("DELETE FROM recipe WHERE key = 'origins'");
    ContinueRecipe(database, TestRecipe());
    const RecordTables tables(database);
    EXPECT_FALSE(tables.complete());
    Statement put(database,
                  "UPDATE missions SET checksum = ?, steps_checksum = ? WHERE run = ? AND mission = ?");
    for (const sweep::RunId& id : {sweep::RunId{0, 0, 0}, sweep::RunId{2, 1, 3}}) {
      const Checksums checksums = tables.Of(TestLayout(), id, TestRecord(id));
      put.Run(checksums.mission, checksums.steps, TestLayout().RunIndex(id), std::int64_t{id.mission});
    }
  }
  ResultReader reader(temp / "run");
  EXPECT_EQ(reader.FindDamage().size(), 0u);
  mission::MissionRecord wanted = TestRecord({2, 1, 3});
  wanted.network = mission::MissionRecord{}.network;
  EXPECT_EQ(wanted.network, -1);
  for (mission::TimestepRecord& step : wanted.steps) step.rate_bps = mission::TimestepRecord{}.rate_bps;
  EXPECT_EQ(CanonicalBytes(reader.LoadMission({2, 1, 3}).record), CanonicalBytes(wanted));
  // Its missing columns are no part of what is checked, all others are.
  Sql(ResultsIn(temp / "run"), "UPDATE missions SET halts = halts + 1 WHERE run = 3");
  EXPECT_EQ(ResultReader(temp / "run").FindDamage().size(), 1u);
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(temp / "run", TestRecipe(), TestLayout()); }),
                       "it can be read, but not continued"));
}

TEST(FormatTest, ColumnsInAnotherOrderAreTheSameRecord) {
  const StoredColumns<mission::MissionRecord> known([] {
    std::vector<std::string> names;
    for (const Column& column : ColumnsOf<mission::MissionRecord>()) names.push_back(column.name);
    return names;
  }());
  std::string bytes, wanted;
  known.Append(bytes, TestRecord({0, 0, 0}));
  AppendColumns(wanted, TestRecord({0, 0, 0}));
  EXPECT_EQ(bytes, wanted);
  const StoredColumns<mission::MissionRecord> two({"halts", "scenario"});
  EXPECT_EQ(two.names(), "halts, scenario");
  bytes.clear();
  mission::MissionRecord record;
  record.scenario = 3;
  record.halts = 5;
  two.Append(bytes, record);
  wanted.clear();
  AppendInt(wanted, 5);
  AppendInt(wanted, 3);
  EXPECT_EQ(bytes, wanted);
  EXPECT_EQ(StoredColumns<mission::MissionRecord>({"halts", "sceanrio"}).unknown(), "sceanrio");
}

}  // namespace
}  // namespace ed3r::store
