// Files that are not what they should be: one line, no harm done.
#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <functional>
#include <iterator>

#include "engine/store/digest.h"
#include "engine/store/tally.h"
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

// Reader and writer must both refuse with `part` in the message.
void ExpectRefused(const std::string& dir, const std::string& part) {
  const auto size = fs::file_size(ResultsIn(dir));
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader reader(dir); }), part));
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(dir, TestRecipe(), TestLayout()); }), part));
  EXPECT_EQ(fs::file_size(ResultsIn(dir)), size);
}

TEST(DamageTest, NothingThere) {
  const TempDir temp;
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader reader(temp / "none"); }), "no such directory"));
  fs::create_directories(temp / "empty");
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader reader(temp / "empty"); }),
                       "no results in it (results.sqlite is missing)"));
}

std::vector<unsigned char> BytesOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool disk_fails = false;
int error_of_disk = EIO;
using Pread = ssize_t (*)(int, void*, size_t, off64_t);
Pread system_pread = nullptr;

// From the second page on, a disk that cannot be read.
ssize_t FailingPread(int file, void* bytes, size_t size, off64_t at) {
  if (!disk_fails || at < 16384) return system_pread(file, bytes, size, at);
  errno = error_of_disk;
  return -1;
}

TEST(DamageTest, ADiskThatCannotBeReadIsNotDamage) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  sqlite3_vfs* const vfs = sqlite3_vfs_find(nullptr);
  system_pread = reinterpret_cast<Pread>(vfs->xGetSystemCall(vfs, "pread64"));
  ASSERT_NE(system_pread, nullptr);
  vfs->xSetSystemCall(vfs, "pread64", reinterpret_cast<sqlite3_syscall_ptr>(FailingPread));
  const auto refusal = [&](const std::function<void(ResultReader&)>& read) -> std::string {
    disk_fails = false;
    ResultReader reader(temp / "run");
    disk_fails = true;
    try {
      read(reader);
    } catch (const StoreError& error) {
      return error.what();
    } catch (const std::exception& error) {
      return std::string("another error: ") + error.what();
    }
    return "none";
  };
  const std::string said = ResultsIn(temp / "run") +
                           ": cannot be read: Input/output error; the disk has failed, which says nothing "
                           "of what is stored";
  EXPECT_EQ(refusal([](ResultReader& reader) { DigestOf(reader); }), said);
  EXPECT_EQ(refusal([](ResultReader& reader) { reader.FindDamage(); }), said);
  error_of_disk = ENOMEM;
  EXPECT_EQ(refusal([](ResultReader& reader) { reader.FindDamage(); }),
            ResultsIn(temp / "run") +
                ": cannot be read: Cannot allocate memory; the system has failed, which says "
                "nothing of what is stored");
  error_of_disk = EIO;
  disk_fails = false;
  vfs->xSetSystemCall(vfs, "pread64", nullptr);
  EXPECT_EQ(ResultReader(temp / "run").FindDamage().size(), 0u);
}

TEST(DamageTest, AnIndexThatHoldsNothing) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  Sql(ResultsIn(temp / "run"),
      "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET rootpage = (SELECT rootpage FROM sqlite_schema "
      "WHERE name = 'failures') WHERE name = 'missions_by_run'");
  Tally tally(TestRecipe(), TestLayout());
  tally.Add(temp / "run");
  for (const ArmStatus& arm : tally.Arms()) EXPECT_EQ(arm.done, arm.planned) << arm.arm;
  EXPECT_EQ(ResultReader(temp / "run").CountMissions(), std::ssize(AllMissions(TestLayout())));
}

// The tree of the missions is walked, whatever the index says; SQLite's own check says what is wrong with that.
TEST(DamageTest, AnIndexThatLeadsElsewhere) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  const std::string digest = DigestOfDir(temp / "run");
  Sql(ResultsIn(temp / "run"),
      "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET rootpage = (SELECT rootpage FROM sqlite_schema "
      "WHERE "
      "name = 'timings') WHERE name = 'missions_by_run'");
  EXPECT_EQ(DigestOfDir(temp / "run"), digest);
  const std::string damage = "the file is damaged: SQLite's own check says";
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").FindDamage(); }), damage));
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").CheckWhole(); }), damage));
  EXPECT_TRUE(Contains(
      UserErrorOf([&] { ResultStore::Open(temp / "run", TestRecipe(), TestLayout())->FindDamage(); }),
      damage));
}

// One child of the tree in another's place: its rows come twice, those of the other not at all.
TEST(DamageTest, ATreeThatLeadsAstray) {
  constexpr std::size_t kPageBytes = 16384, kCells = 3, kPointers = 12;
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  const std::string file = ResultsIn(temp / "run");
  std::size_t root = 0;
  {
    Connection database(file, Connection::Access::kReadOnly);
    root =
        static_cast<std::size_t>(database.Int("SELECT rootpage FROM sqlite_schema WHERE name = 'missions'"));
  }
  std::vector<unsigned char> bytes = BytesOf(file);
  unsigned char* const page = bytes.data() + (root - 1) * kPageBytes;
  ASSERT_GE(page[kCells] << 8 | page[kCells + 1], 2) << "an inner page with children";
  const auto child = [&](std::size_t cell) {
    return page + (page[kPointers + 2 * cell] << 8 | page[kPointers + 2 * cell + 1]);
  };
  std::copy(child(0), child(0) + 4, child(1));
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const std::string damage = "the file is damaged: ";
  EXPECT_TRUE(Contains(UserErrorOf([&] { DigestOfDir(temp / "run"); }), damage));
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(temp / "run").FindDamage(); }), damage));
  EXPECT_TRUE(Contains(UserErrorOf([&] {
                         ResultReader reader(temp / "run");
                         reader.ForEachMission(0, 0, Steps::kSkip, [](const StoredMission&) {});
                         reader.ForEachMission(2, 0, Steps::kSkip, [](const StoredMission&) {});
                       }),
                       damage));
}

TEST(DamageTest, ATableThatHasLostItsKey) {
  for (const std::string table : {"timings", "missions", "failures", "timesteps"}) {
    SCOPED_TRACE(table);
    const TempDir temp;
    WriteStore(temp / "run", {{0, 0, 0}, {2, 1, 3}});
    Sql(ResultsIn(temp / "run"),
        "DROP VIEW named_missions; DROP VIEW named_timesteps; CREATE TABLE t AS SELECT * FROM " + table +
            "; DROP TABLE " + table + "; ALTER TABLE t RENAME TO " + table + "; INSERT INTO " + table +
            " SELECT * FROM " + table);
    ExpectRefused(temp / "run", "its table " + table + " has lost its key");
  }
}

// Without the column of checksums nothing would be compared, and 'verify' would call halved numbers whole.
TEST(DamageTest, AColumnThatIsNotThere) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}, {2, 1, 3}});
  Connection database(ResultsIn(temp / "run"), Connection::Access::kReadOnly);
  std::vector<std::string> of_records = {"kind", "seal"};  // may not be there (schema.h)
  for (const Column& column : ColumnsOf<mission::MissionRecord>()) of_records.push_back(column.name);
  for (const Column& column : ColumnsOf<mission::TimestepRecord>()) of_records.push_back(column.name);
  Statement tables(database, "SELECT name FROM sqlite_schema WHERE type = 'table'");
  int columns_tried = 0;
  while (tables.Step()) {
    const std::string table = tables.Text(0);
    Statement columns(database, fmt::format("SELECT name FROM pragma_table_info('{}') WHERE pk = 0", table));
    while (columns.Step()) {
      const std::string column = columns.Text(0);
      const bool of_record = (table == "missions" || table == "timesteps" || column == "kind") &&
                             std::count(of_records.begin(), of_records.end(), column) > 0;
      if (of_record) continue;
      SCOPED_TRACE(table + '.' + column);
      const TempDir other;
      fs::copy(temp / "run", other / "run");
      Sql(ResultsIn(other / "run"),
          fmt::format("DROP VIEW named_missions; DROP VIEW named_timesteps; ALTER TABLE {} DROP COLUMN {}",
                      table, column));
      ExpectRefused(other / "run", fmt::format("its table {} has no column {}", table, column));
      ++columns_tried;
    }
  }
  EXPECT_EQ(columns_tried, 27);
}

TEST(DamageTest, AColumnOfAnotherTypeOrThatComputes) {
  const TempDir temp;
  for (const char* name : {"type", "computed"}) WriteStore(temp / name, {{0, 0, 0}});
  Sql(ResultsIn(temp / "type"),
      "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'total_j REAL', 'total_j "
      "TEXT') "
      "WHERE name = 'missions'");
  ExpectRefused(temp / "type", "its table missions has a column total_j of type 'TEXT', not REAL");
  Sql(ResultsIn(temp / "computed"),
      "DROP VIEW named_missions; ALTER TABLE missions DROP COLUMN checksum; "
      "ALTER TABLE missions ADD COLUMN checksum TEXT AS ('')");
  ExpectRefused(temp / "computed", "its table missions has no column checksum");
}

TEST(DamageTest, ADirectoryThatCannotBeMade) {
  const TempDir temp;
  std::ofstream(temp / "file") << "text";
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(temp / "file/run", TestRecipe(), TestLayout()); }),
                       temp / "file"));
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(temp / "file", TestRecipe(), TestLayout()); }),
                       temp / "file"));
}

TEST(DamageTest, NotADatabase) {
  const TempDir temp;
  fs::create_directories(temp / "run");
  std::ofstream(ResultsIn(temp / "run")) << std::string(5000, 'x');
  ExpectRefused(temp / "run", "not a results file (file is not a database)");
}

TEST(DamageTest, AHeaderThatSqliteDoesNotKnow) {
  constexpr std::streamoff kSchemaFormat =
      44;  // in SQLite's header: four bytes, of which formats 1 to 4 are known
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  {
    std::fstream file(ResultsIn(temp / "run"), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(kSchemaFormat);
    file.write("\0\0\0\x40", 4);
  }
  ExpectRefused(temp / "run", "the file is damaged (unsupported file format)");
}

TEST(DamageTest, SomebodyElsesDatabase) {
  const TempDir temp;
  fs::create_directories(temp / "run");
  Sql(ResultsIn(temp / "run"), "CREATE TABLE missions (a); INSERT INTO missions VALUES (1)");
  ExpectRefused(temp / "run", "an SQLite file, but not one of ed3r");
}

TEST(DamageTest, ANewerOrOlderSchema) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  Sql(ResultsIn(temp / "run"), fmt::format("PRAGMA user_version = {}", kSchemaVersion + 1));
  ExpectRefused(temp / "run", "written by a newer ed3r");
  Sql(ResultsIn(temp / "run"), "PRAGMA user_version = 0");
  ExpectRefused(temp / "run", "written by an older ed3r");
}

TEST(DamageTest, OtherColumns) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  Sql(ResultsIn(temp / "run"), "ALTER TABLE timesteps RENAME COLUMN scs TO score");
  ExpectRefused(temp / "run", "written by another version of ed3r: this one does not know its column score");
}

TEST(DamageTest, ATableThatComputesAndATriggerThatWrites) {
  const TempDir temp;
  WriteStore(temp / "view", {{0, 0, 0}});
  Sql(ResultsIn(temp / "view"),
      "ALTER TABLE missions RENAME TO other; CREATE VIEW Missions AS WITH RECURSIVE n(i) AS (SELECT 0 UNION "
      "ALL SELECT i + 1 FROM n) SELECT other.* FROM n JOIN other");
  ExpectRefused(temp / "view", "'Missions' is a view, where ed3r has a table");
  WriteStore(temp / "trigger", {{0, 0, 0}});
  Sql(ResultsIn(temp / "trigger"),
      "CREATE TRIGGER halve AFTER INSERT ON missions BEGIN UPDATE missions SET total_j = total_j / 2; END");
  ExpectRefused(temp / "trigger", "'halve' is a trigger, where ed3r has none");
}

TEST(DamageTest, TablesAndViewsOfOnesOwnAreLeftAlone) {
  const TempDir temp;
  WriteStore(temp / "run", {{0, 0, 0}});
  Sql(ResultsIn(temp / "run"),
      "CREATE TABLE mine (x); CREATE VIEW my_missions AS SELECT total_j FROM missions");
  EXPECT_EQ(ResultReader(temp / "run").CountMissions(), 1);
}

// No reader of ours asks them, but whoever looks with SQL does.
TEST(DamageTest, AViewThatTellsAnotherColumnIsNamedAndMadeAnew) {
  const TempDir temp;
  const std::string run = temp / "run";
  WriteStore(run, {{0, 0, 0}});
  EXPECT_NO_THROW(ResultReader(run).CheckViews());
  const std::string text =
      "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'timesteps.x_m AS x_m', "
      "'timesteps.y_m AS x_m') WHERE name = 'named_timesteps'";
  Sql(ResultsIn(run), text);
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultReader(run).CheckViews(); }),
                       "the file is damaged: its view named_timesteps is not as it was made"));
  WriteStore(run, {{0, 0, 1}});
  EXPECT_NO_THROW(ResultReader(run).CheckViews());
  const mission::MissionRecord flown = TestRecord({0, 0, 1});
  Connection look(ResultsIn(run), Connection::Access::kReadOnly);
  Statement select(look, "SELECT x_m FROM named_timesteps WHERE mission = 1 ORDER BY k");
  for (const mission::TimestepRecord& step : flown.steps) {
    ASSERT_TRUE(select.Step());
    EXPECT_EQ(select.Real(0), step.x_m);
  }
  EXPECT_FALSE(select.Step());
}

TEST(DamageTest, AViewInOtherLettersIsTheSameViewAndATableOfItsNameIsSomebodysOwn) {
  const TempDir temp;
  WriteStore(temp / "letters", {{0, 0, 0}});
  Sql(ResultsIn(temp / "letters"),
      "DROP VIEW named_timesteps; CREATE VIEW Named_Timesteps AS SELECT 'x' AS stage");
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { ResultReader(temp / "letters").CheckViews(); }), "view named_timesteps"));
  WriteStore(temp / "letters", {{0, 0, 1}});
  EXPECT_NO_THROW(ResultReader(temp / "letters").CheckViews());

  WriteStore(temp / "table", {{0, 0, 0}});
  Sql(ResultsIn(temp / "table"),
      "CREATE TABLE mine AS SELECT * FROM named_missions; DROP VIEW named_missions; ALTER TABLE mine RENAME "
      "TO "
      "named_missions");
  WriteStore(temp / "table", {{0, 0, 1}});
  ResultReader reader(temp / "table");
  EXPECT_NO_THROW(reader.CheckViews());
  EXPECT_EQ(reader.CountMissions(), 2);
}

// Two sessions of one host would not fit.
TEST(DamageTest, AnIndexThatAllowsAValueOnlyOnceIsNotWrittenUnder) {
  const TempDir temp;
  const std::string run = temp / "run";
  WriteStore(run, {{0, 0, 0}});
  Sql(ResultsIn(run), "CREATE INDEX mine ON sessions (host)");
  WriteStore(run, {{0, 0, 1}});
  Sql(ResultsIn(run),
      "DROP INDEX mine; UPDATE sessions SET host = session; CREATE UNIQUE INDEX once ON sessions (host)");
  EXPECT_EQ(ResultReader(run).CountMissions(), 2);
  EXPECT_TRUE(Contains(UserErrorOf([&] {
                         WriteStore(run, {{0, 0, 2}});
                       }),
                       "its index 'once' allows a value only once, where ed3r has no such index"));
}

TEST(DamageTest, AColumnThatSomebodyAddedIsLeftAlone) {
  const TempDir temp;
  const std::string run = temp / "run";
  WriteStore(run, {{0, 0, 0}});
  for (const char* table : {"recipe", "code", "inputs", "places", "files", "stages", "runs", "networks",
                            "flown_networks", "sessions", "session_notes", "failures", "timings"})
    Sql(ResultsIn(run), fmt::format("ALTER TABLE {} ADD COLUMN note TEXT", table));
  const auto store = ResultStore::Open(run, TestRecipe(), TestLayout());
  store->Put({0, 0, 1}, TestRecord({0, 0, 1}), 0.25);
  store->PutNetworks({.files = {{"aaaa", {"a network", "bytes"}}}, .uses = {{2, 1, 0, "rc", "aaaa"}}});
  store->PutNote("name", "text");
  store->Commit();
  ResultReader reader(run);
  EXPECT_EQ(reader.CountMissions(), 2);
  EXPECT_TRUE(reader.FindDamage().empty());
}

TEST(DamageTest, ALinkToNowhereIsNotWrittenThrough) {
  const TempDir temp;
  fs::create_directories(temp / "run");
  fs::create_symlink("elsewhere", ResultsIn(temp / "run"));
  EXPECT_TRUE(Contains(UserErrorOf([&] { ResultStore::Open(temp / "run", TestRecipe(), TestLayout()); }),
                       "is a link to a file that is not there"));
  EXPECT_FALSE(fs::exists(temp / "run/elsewhere"));
}

TEST(DamageTest, ATruncatedFile) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  fs::resize_file(ResultsIn(temp / "run"), fs::file_size(ResultsIn(temp / "run")) / 2);
  ExpectRefused(temp / "run", "damaged");
}

TEST(DamageTest, OverwrittenPagesAreFoundWhenTheyAreRead) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  {
    std::fstream file(ResultsIn(temp / "run"), std::ios::in | std::ios::out | std::ios::binary);
    const auto size = static_cast<std::streamoff>(fs::file_size(ResultsIn(temp / "run")));
    file.seekp(size / 2);
    file << std::string(static_cast<std::size_t>(size - size / 2), '\xff');
  }
  const std::string error = UserErrorOf([&] {
    ResultReader reader(temp / "run");
    DigestOf(reader);
  });
  EXPECT_TRUE(Contains(error, ResultsIn(temp / "run") + ": the file is damaged"));
}

}  // namespace
}  // namespace ed3r::store
