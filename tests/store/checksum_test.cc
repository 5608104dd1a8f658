// Numbers that were changed behind the engine's back: every reader names the mission, and a repair flies it again.
#include <sqlite3.h>

#include <bit>
#include <fstream>
#include <functional>
#include <iterator>

#include "engine/store/columns.h"
#include "engine/store/seals.h"
#include "engine/store/shards/merge.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

void Sql(const std::string& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sql << ": " << sqlite3_errmsg(database);
  sqlite3_close(database);
}

std::vector<std::string> DamagedIn(const std::string& dir) {
  ResultReader reader(dir);
  std::vector<std::string> names;
  for (const DamagedMission& damage : reader.FindDamage()) names.push_back(damage.name + ": " + damage.what);
  return names;
}

class ChecksumTest : public ::testing::Test {
 protected:
  ChecksumTest() {
    WriteStore(Run(), AllMissions(TestLayout()));
    digest_ = DigestOfDir(Run());
  }
  std::string Run() const { return temp_ / "run"; }

  // Takes the damage out, flies what is missing, and has what was there before.
  void ExpectRepairable() {
    const auto store = ResultStore::Open(Run(), TestRecipe(), TestLayout());
    store->Remove(store->FindDamage());
    const std::vector<sweep::RunId> stored = store->Stored();
    for (const sweep::RunId& id : AllMissions(TestLayout()))
      if (!std::binary_search(stored.begin(), stored.end(), id)) store->Put(id, TestRecord(id), 0.25);
    store->Commit();
    EXPECT_EQ(DigestOfDir(Run()), digest_);
    EXPECT_EQ(DamagedIn(Run()), std::vector<std::string>{});
  }

  TempDir temp_;
  std::string digest_;
};

TEST_F(ChecksumTest, AWholeStoreHasNoDamage) { EXPECT_TRUE(DamagedIn(Run()).empty()); }

// Each of its checksums fits: only the recipe tells that it is none of this run's.
TEST_F(ChecksumTest, AWholeMissionOfAnotherRunIsNamed) {
  Recipe other = TestRecipe();
  other.plan_text += "  robot.mass_kg: 2\n";
  WriteStore(temp_ / "other", AllMissions(TestLayout()), other);
  Sql(ResultsIn(Run()),
      "DELETE FROM missions WHERE run = 3 AND mission = 6;"
      "ATTACH '" +
          ResultsIn(temp_ / "other") +
          "' AS other;"
          "INSERT INTO main.missions SELECT * FROM other.missions WHERE run = 3 AND mission = 6");
  EXPECT_EQ(DamagedIn(Run()), std::vector<std::string>{"stage online, arm ed3r-75, mission 6: its seal is "
                                                       "not of this run's recipe and networks: a mission "
                                                       "of another run, or a damaged seal"});
  ExpectRepairable();
}

TEST_F(ChecksumTest, OtherWorldsAndOtherCodeAreAnotherRun) {
  Recipe worlds = TestRecipe(), code = TestRecipe();
  worlds.inputs["worlds/ridges.yaml"] = "fingerprint-2";
  code.code["flight"] = {"4567cdef"};
  for (const Recipe& other : {worlds, code}) {
    const TempDir temp;
    WriteStore(temp / "other", {{0, 0, 1}}, other);
    Sql(ResultsIn(Run()), "ATTACH '" + ResultsIn(temp / "other") +
                              "' AS other;"
                              "INSERT OR REPLACE INTO main.missions SELECT * FROM other.missions WHERE run = "
                              "0 AND mission = 1");
    EXPECT_EQ(DamagedIn(Run()).size(), 1u);
    ExpectRepairable();
  }
}

// The recipe is one that the file has had, too: only the networks tell.
TEST_F(ChecksumTest, AMissionThatAskedOtherNetworksIsNamed) {
  FlownNetworks networks;
  networks.files["aaaa"] = {"rc, seed 5", "model one"};
  networks.uses.push_back({.stage = 2, .arm = 1, .seed = 5, .agent = "rc", .sha256 = "aaaa"});
  mission::MissionRecord record = TestRecord({2, 1, 3});
  record.network = 5;
  const auto put = [&](const std::string& dir) {
    const auto store = ResultStore::Open(dir, TestRecipe(), TestLayout());
    store->PutNetworks(networks);
    store->Put({2, 1, 3}, record, 0.25);
    store->Commit();
  };
  put(temp_ / "one");
  put(temp_ / "same");
  networks.files = {{"bbbb", {"rc, seed 5", "model two"}}};
  networks.uses[0].sha256 = "bbbb";
  put(temp_ / "other");
  const auto take = [&](const std::string& from) {
    Sql(ResultsIn(temp_ / "one"), "ATTACH '" + ResultsIn(temp_ / from) +
                                      "' AS other;"
                                      "INSERT OR REPLACE INTO main.missions SELECT * FROM other.missions");
    return DamagedIn(temp_ / "one").size();
  };
  EXPECT_EQ(take("same"), 0u);
  EXPECT_EQ(take("other"), 1u);
}

TEST_F(ChecksumTest, MissionsOfEachCodeThatContinuedARunAreItsOwn) {
  Recipe newer = TestRecipe();
  newer.code["flight"] = {"89abcdef"};
  const std::string dir = temp_ / "mixed";
  WriteStore(dir, {{0, 0, 1}});
  ResultStore::Open(dir, newer, TestLayout(), {.other_code = OtherCode::kAccept})
      ->Put({0, 0, 2}, TestRecord({0, 0, 2}), 0.25);
  {
    const auto store = ResultStore::Open(dir, newer, TestLayout());
    store->Put({0, 0, 3}, TestRecord({0, 0, 3}), 0.25);
    store->Commit();
  }
  const auto store = ResultStore::Open(dir, TestRecipe(), TestLayout());
  store->Put({0, 0, 4}, TestRecord({0, 0, 4}), 0.25);
  store->Commit();
  EXPECT_EQ(store->Stored().size(), 3u);  // what was not committed is gone
  EXPECT_EQ(DamagedIn(dir), std::vector<std::string>{});
}

TEST_F(ChecksumTest, SealsThatAreGoneAreDamage) {
  Sql(ResultsIn(Run()), "DROP VIEW named_missions; ALTER TABLE missions DROP COLUMN seal");
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { ResultReader reader(Run()); }), "its missions have lost their seals"));
}

TEST_F(ChecksumTest, AFileOfBeforeHasNoSealsAndGoesOnWithout) {
  {
    Connection database(ResultsIn(Run()), Connection::Access::kReadWrite);
    database.Execute(
        "DROP VIEW named_missions; ALTER TABLE missions DROP COLUMN seal; DELETE FROM missions WHERE run = "
        "0; "
        "DELETE FROM timesteps WHERE run = 0; DELETE FROM timings WHERE run = 0; "
        "DELETE FROM recipe WHERE key = 'origins'");
    ContinueRecipe(database, TestRecipe());
  }
  const auto store = ResultStore::Open(Run(), TestRecipe(), TestLayout());
  store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0.25);
  store->Commit();
  Connection database(ResultsIn(Run()), Connection::Access::kReadOnly);
  EXPECT_FALSE(HasSeals(database));
  EXPECT_EQ(store->Stored().size(), 61u);
  EXPECT_TRUE(store->FindDamage().empty());
}

TEST_F(ChecksumTest, WhoChecksTheWholeStoreKnowsItsDigest) {
  ResultReader reader(Run());
  EXPECT_EQ(reader.CheckWhole(), DigestOf(reader));
}

TEST_F(ChecksumTest, EveryReaderNamesAMissionWithAnotherNumber) {
  Sql(ResultsIn(Run()), "UPDATE missions SET total_j = total_j * 1.0000000001 WHERE run = 3 AND mission = 4");
  const std::string wanted =
      ResultsIn(Run()) +
      ": stage online, arm ed3r-75, mission 4 is damaged: its record does not match its "
      "checksum; 'ed3r verify DIR' names all that is damaged, 'ed3r run SWEEP --repair' flies "
      "it again";
  const auto expect_named = [&](const std::function<void(ResultReader&)>& read) {
    EXPECT_EQ(UserErrorOf([&] {
                ResultReader reader(Run());
                read(reader);
              }),
              wanted);
  };
  expect_named([](ResultReader& reader) { DigestOf(reader); });
  expect_named(
      [](ResultReader& reader) { reader.ForEachMission(Steps::kSkip, [](const StoredMission&) {}); });
  expect_named(
      [](ResultReader& reader) { reader.ForEachTimestep(2, 1, [](int, const mission::TimestepRecord&) {}); });
  expect_named([](ResultReader& reader) { reader.LoadMission({2, 1, 4}); });
  EXPECT_EQ(UserErrorOf([&] { MergeStores(temp_ / "new", {Run()}); }), wanted);
  EXPECT_FALSE(std::filesystem::exists(temp_ / "new"));
  EXPECT_EQ(DamagedIn(Run()).size(), 1u);
  ExpectRepairable();
}

TEST_F(ChecksumTest, TimestepsAreComparedByWhoeverReadsThem) {
  Sql(ResultsIn(Run()), "UPDATE timesteps SET cpu_hz = cpu_hz + 1 WHERE run = 0 AND k = 3");
  ResultReader reader(Run());
  EXPECT_NO_THROW(reader.ForEachMission(0, 0, Steps::kSkip, [](const StoredMission&) {}));
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { reader.ForEachMission(0, 0, Steps::kLoad, [](const StoredMission&) {}); }),
               "its timesteps do not match their checksum"));
  EXPECT_GT(DamagedIn(Run()).size(), 5u);
  ExpectRepairable();
}

TEST_F(ChecksumTest, WhatIsMissingOrTooMuchIsNamed) {
  Sql(ResultsIn(Run()), "DELETE FROM timesteps WHERE run = 2 AND mission = 3 AND k = 1");
  Sql(ResultsIn(Run()), "DELETE FROM missions WHERE run = 3 AND mission = 6");
  Sql(ResultsIn(Run()), "UPDATE missions SET mission = 77 WHERE run = 0 AND mission = 9");
  Sql(ResultsIn(Run()), "UPDATE timesteps SET mission = 77 WHERE run = 0 AND mission = 9");
  Sql(ResultsIn(Run()),
      "INSERT INTO failures (run, mission, scenario, seed, message) VALUES (0, 99, 0, 7, 'never planned')");
  EXPECT_EQ(DamagedIn(Run()),
            (std::vector<std::string>{
                "stage warmup, arm warmup, mission 77: the plan has no such mission",
                "stage online, arm rbs, mission 3: its timesteps do not match their checksum",
                "stage online, arm ed3r-75, mission 6: there are timesteps of it, but no record",
                "stage warmup, arm warmup, mission 99: it is said to have failed, but the plan has no such "
                "mission"}));
  ExpectRepairable();
}

TEST_F(ChecksumTest, AFailureOfAMissionThatIsStoredIsNamed) {
  Sql(ResultsIn(Run()),
      "INSERT INTO failures (run, mission, scenario, seed, message) VALUES (2, 3, 5003, 7, 'it flew')");
  EXPECT_EQ(DamagedIn(Run()),
            (std::vector<std::string>{
                "stage online, arm rbs, mission 3: it is said to have failed, and its record is stored"}));
  ExpectRepairable();
}

TEST_F(ChecksumTest, AMissionInAnothersPlaceIsNamed) {
  // Both are whole, but each says what the other should say.
  Sql(ResultsIn(Run()),
      "UPDATE missions SET mission = 1000 WHERE run = 2 AND mission = 0;"
      "UPDATE missions SET mission = 0 WHERE run = 2 AND mission = 1;"
      "UPDATE missions SET mission = 1 WHERE run = 2 AND mission = 1000;"
      "UPDATE timesteps SET mission = 1000 WHERE run = 2 AND mission = 0;"
      "UPDATE timesteps SET mission = 0 WHERE run = 2 AND mission = 1;"
      "UPDATE timesteps SET mission = 1 WHERE run = 2 AND mission = 1000");
  EXPECT_EQ(DamagedIn(Run()).size(), 2u);
  ExpectRepairable();
}

TEST_F(ChecksumTest, TextInANumbersPlaceIsRefusedBySqlite) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(ResultsIn(Run()).c_str(), &database), SQLITE_OK);
  EXPECT_NE(sqlite3_exec(database, "UPDATE missions SET total_j = 'much'", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
}

TEST_F(ChecksumTest, AnotherPlanOrLayoutIsRefused) {
  for (const char* change :
       {"UPDATE runs SET name = 'rbt' WHERE run = 2", "UPDATE stages SET missions = 31",
        "UPDATE recipe SET value = value || 'x' WHERE key = 'plan'", "UPDATE inputs SET fingerprint = 'x'",
        "DELETE FROM recipe WHERE key = 'checksum'"}) {
    const TempDir temp;
    WriteStore(temp / "run", {{0, 0, 0}});
    Sql(ResultsIn(temp / "run"), change);
    EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader reader(temp / "run"); }),
                         "its plan, layout or inputs do not match their checksum"))
        << change;
  }
}

TEST_F(ChecksumTest, AMergeLooksAtWhatItAddsTo) {
  WriteStore(temp_ / "other", {{0, 0, 0}});
  Sql(ResultsIn(Run()), "UPDATE missions SET halts = halts + 1 WHERE run = 2 AND mission = 5");
  EXPECT_TRUE(Contains(UserErrorOf([&] { MergeStores(Run(), {temp_ / "other"}); }),
                       "stage online, arm rbs, mission 5 is damaged"));
}

// One bit of one number in one row: named, or (the sign of a zero, the payload of a NaN) no number has changed.
TEST_F(ChecksumTest, FlippedBitsAreNamedOrHarmless) {
  const std::vector<Column> missions = ColumnsOf<mission::MissionRecord>(),
                            timesteps = ColumnsOf<mission::TimestepRecord>();
  Stream stream(20260101, 0, Purpose::kScenario);
  int named = 0;
  for (int flip = 0; flip < 60; ++flip) {
    const bool step = stream.Below(2) == 0;
    const std::vector<Column>& columns = step ? timesteps : missions;
    Column column = columns[stream.Below(static_cast<std::uint32_t>(columns.size()))];
    while (!column.is_real) column = columns[stream.Below(static_cast<std::uint32_t>(columns.size()))];
    Connection database(ResultsIn(Run()), Connection::Access::kReadWrite);
    const std::string table = step ? "timesteps" : "missions";
    Statement pick(database, fmt::format("SELECT run, mission, {}, {} FROM {} LIMIT 1 OFFSET {}", column.name,
                                         step ? "k" : "0", table, stream.Below(100)));
    ASSERT_TRUE(pick.Step());
    const std::int64_t run = pick.Int(0), mission = pick.Int(1), k = pick.Int(3);
    const double value = pick.Real(2);
    pick.Reset();
    const double flipped =
        std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ (std::uint64_t{1} << stream.Below(64)));
    Statement put(database, fmt::format("UPDATE {} SET {} = ? WHERE run = ? AND mission = ?{}", table,
                                        column.name, step ? fmt::format(" AND k = {}", k) : ""));
    put.Run(flipped, run, mission);
    const std::vector<std::string> damage = DamagedIn(Run());
    const bool same =
        std::bit_cast<std::uint64_t>(Canonical(flipped)) == std::bit_cast<std::uint64_t>(Canonical(value));
    ASSERT_EQ(damage.size(), same ? 0u : 1u) << column.name << " " << value << " -> " << flipped;
    if (!same) {
      EXPECT_TRUE(Contains(damage[0], fmt::format("mission {}:", mission)));
      ++named;
    }
    put.Run(value, run, mission);
  }
  EXPECT_GT(named, 50);
  EXPECT_EQ(DigestOfDir(Run()), digest_);
}

// Bits of the file itself, wherever they lie: whoever reads it says so, or every mission is as it was.
TEST_F(ChecksumTest, FlippedBitsOfTheFileNeverChangeAMission) {
  const auto bytes_of = [](const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string whole = bytes_of(ResultsIn(Run()));
  Stream stream(20260102, 0, Purpose::kScenario);
  int named = 0;
  for (int flip = 0; flip < 200; ++flip) {
    std::string bytes = whole;
    bytes[stream.Below(static_cast<std::uint32_t>(bytes.size()))] ^= static_cast<char>(1 << stream.Below(8));
    std::ofstream(ResultsIn(Run()), std::ios::binary) << bytes;
    try {
      if (DamagedIn(Run()).empty())
        EXPECT_EQ(DigestOfDir(Run()), digest_) << "flip " << flip;
      else
        ++named;
    } catch (const UserError&) {
      ++named;
    } catch (const InternalError&) {  // SQLite's "malformed schema"
      ++named;
    }
  }
  EXPECT_GT(named, 20);
}

}  // namespace
}  // namespace ed3r::store
