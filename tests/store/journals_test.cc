// What lies beside a results file under the name of its journal is its own, or it is not touched.
#include "engine/store/journals.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "engine/store/sqlite.h"
#include "tests/store/store_fixture.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

const sweep::RunId kNotFlown{0, 0, 9};
const std::vector<sweep::RunId> kFew = {{0, 0, 0}, {0, 0, 1}}, kMore = {{0, 0, 2}, {0, 0, 3}, {2, 1, 5}};

// The files of `from` as a kill would leave them at this moment.
void CopyAsKilled(const std::string& from, const std::string& to) {
  fs::create_directories(to);
  for (const char* suffix : {"", "-wal", "-journal"})
    if (fs::exists(ResultsIn(from) + suffix))
      fs::copy_file(ResultsIn(from) + suffix, ResultsIn(to) + suffix, fs::copy_options::overwrite_existing);
}

// `killed` reads and goes on; with `other`'s file in its place it is refused, and that file stays as it is.
void ExpectBound(const std::string& killed, const std::string& other, const std::string& suffix,
                 const std::string& digest_of_killed) {
  const TempDir temp;
  CopyAsKilled(killed, temp / "own");
  ASSERT_TRUE(fs::exists(ResultsIn(temp / "own") + suffix));
  EXPECT_EQ(DigestOfDir(temp / "own"), digest_of_killed);
  CopyAsKilled(killed, temp / "mixed");
  fs::copy_file(ResultsIn(other), ResultsIn(temp / "mixed"), fs::copy_options::overwrite_existing);
  const std::string digest = DigestOfDir(other);
  const auto refused = [&](const auto& action) {
    EXPECT_TRUE(Contains(UserErrorOf(action), ResultsIn(temp / "mixed") + suffix + " is of another results"));
  };
  refused([&] { ResultReader(temp / "mixed").CountMissions(); });
  refused([&] { WriteStore(temp / "mixed", {kNotFlown}); });
  fs::remove(ResultsIn(temp / "mixed") + suffix);
  EXPECT_EQ(DigestOfDir(temp / "mixed"), digest);
  WriteStore(temp / "own", {kNotFlown});  // what was killed goes on
  EXPECT_TRUE(ResultReader(temp / "own").FindDamage().empty());
}

TEST(JournalsTest, AWriteAheadLogIsOfItsFile) {
  const TempDir temp;
  WriteStore(temp / "run", kFew);
  CopyAsKilled(temp / "run", temp / "before");
  WriteStore(temp / "other", kMore);
  WriteStore(temp / "reference", kFew);
  WriteStore(temp / "reference", kMore);
  const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
  for (const sweep::RunId& id : kMore) store->Put(id, TestRecord(id), 0.25);
  store->Commit();
  for (const char* other : {"before", "other", "reference"})
    ExpectBound(temp / "run", temp / other, "-wal", DigestOfDir(temp / "reference"));
}

TEST(JournalsTest, AFileThatBecameSmallerKeepsItsLog) {
  const TempDir temp;
  WriteStore(temp / "run", AllMissions(TestLayout()));
  Connection writer(ResultsIn(temp / "run"), Connection::Access::kReadWrite);
  writer.Execute("PRAGMA journal_mode = WAL; DELETE FROM timesteps; PRAGMA wal_checkpoint(TRUNCATE)");
  const auto before = writer.StateOfFile();
  writer.Execute("VACUUM");
  ASSERT_LT(writer.Int("PRAGMA page_count"), std::int64_t{before->pages});
  CopyAsKilled(temp / "run", temp / "killed");
  ASSERT_TRUE(fs::exists(ResultsIn(temp / "killed") + "-wal"));
  EXPECT_EQ(ResultReader(temp / "killed").CountMissions(), std::ssize(AllMissions(TestLayout())));
}

// Copies of a killed run go on apart, and a log of an earlier round is put back.
TEST(JournalsTest, AWriteAheadLogIsOfItsRound) {
  const TempDir temp;
  {
    const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
    store->Put(kFew[0], TestRecord(kFew[0]), 0.25);
    store->Commit();
    CopyAsKilled(temp / "run", temp / "killed");
    CopyAsKilled(temp / "run", temp / "twin");
    for (int mission = 10; mission < 30; ++mission)
      store->Put({0, 0, mission}, TestRecord({0, 0, mission}), 0.25);
  }
  const auto one = ResultStore::Open(temp / "killed", TestRecipe(), TestLayout());
  one->Put(kFew[1], TestRecord(kFew[1]), 0.25);
  one->Commit();
  const auto other = ResultStore::Open(temp / "twin", TestRecipe(), TestLayout());
  other->Put(kMore[0], TestRecord(kMore[0]), 0.25);
  other->Commit();
  WriteStore(temp / "reference", {kFew[0], kFew[1]});
  ExpectBound(temp / "killed", temp / "run", "-wal", DigestOfDir(temp / "reference"));
  CopyAsKilled(temp / "killed", temp / "mixed");
  fs::copy_file(ResultsIn(temp / "twin") + "-wal", ResultsIn(temp / "mixed") + "-wal",
                fs::copy_options::overwrite_existing);
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { ResultReader reader(temp / "mixed"); }), "-wal is of another results"));
}

TEST(JournalsTest, ARollbackJournalIsOfItsFile) {
  const TempDir temp;
  WriteStore(temp / "before", kFew);
  std::vector<sweep::RunId> many = AllMissions(TestLayout());
  std::erase(many, kNotFlown);
  WriteStore(temp / "other", many);
  std::erase_if(many, [](const sweep::RunId& id) { return std::count(kFew.begin(), kFew.end(), id) > 0; });
  CopyAsKilled(temp / "before", temp / "run");
  WriteStore(temp / "run", many);
  const std::string digest = DigestOfDir(temp / "run");
  {
    Connection database(ResultsIn(temp / "run"), Connection::Access::kReadWrite);
    database.Execute("PRAGMA cache_size = 2; BEGIN IMMEDIATE");
    WriteFirstPage(database);
    database.Execute("UPDATE timesteps SET scs = 0");
    CopyAsKilled(temp / "run", temp / "killed");  // pages that found no room are in the file
    database.Execute("ROLLBACK");
  }
  for (const char* other : {"before", "other"})
    ExpectBound(temp / "killed", temp / other, "-journal", digest);
}

// Locks end when any descriptor of a file is closed; without them the last client that goes takes the log away.
TEST(JournalsTest, ALookAtAFileLeavesItsWritersLocks) {
  const TempDir temp;
  const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
  store->Put(kFew[0], TestRecord(kFew[0]), 0.25);
  store->Commit();
  EXPECT_EQ(ResultReader(temp / "run").CountMissions(), 1);
  LookAtFile(temp / "run");
  RecallFinished(temp / "run", "me");
  const pid_t client = fork();
  ASSERT_GE(client, 0);
  if (client == 0) {
    Connection(ResultsIn(temp / "run"), Connection::Access::kReadWrite).Int("SELECT count(*) FROM missions");
    _exit(0);
  }
  int status = -1;
  ASSERT_EQ(waitpid(client, &status, 0), client);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::exists(ResultsIn(temp / "run") + "-wal"));
  store->Put(kFew[1], TestRecord(kFew[1]), 0.25);
  store->Commit();
  CopyAsKilled(temp / "run", temp / "killed");
  EXPECT_EQ(ResultReader(temp / "killed").CountMissions(), 2);
}

TEST(JournalsTest, ALogIsLookedForBesideWhatALinkLeadsTo) {
  const TempDir temp;
  WriteStore(temp / "backup", kFew);
  const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
  store->Put(kMore[0], TestRecord(kMore[0]), 0.25);
  store->Commit();
  CopyAsKilled(temp / "run", temp / "mixed");
  fs::copy_file(ResultsIn(temp / "backup"), ResultsIn(temp / "mixed"), fs::copy_options::overwrite_existing);
  fs::create_directories(temp / "link");
  fs::create_symlink(ResultsIn(temp / "mixed"), ResultsIn(temp / "link"));
  EXPECT_TRUE(
      Contains(UserErrorOf([&] { ResultReader reader(temp / "link"); }), "-wal is of another results"));
  EXPECT_TRUE(Contains(UserErrorOf([&] { WriteStore(temp / "link", kMore); }), "-wal is of another results"));

  // The file alone was moved, and its log stayed.
  CopyAsKilled(temp / "run", temp / "moved");
  fs::create_directories(temp / "elsewhere");
  fs::rename(ResultsIn(temp / "moved"), ResultsIn(temp / "elsewhere"));
  const auto orphan = [&](const auto& action) {
    EXPECT_TRUE(Contains(UserErrorOf(action), ResultsIn(temp / "moved") + "-wal: holds commits of"));
    EXPECT_TRUE(fs::exists(ResultsIn(temp / "moved") + "-wal"));
  };
  orphan([&] { WriteStore(temp / "moved", kFew); });
  fs::create_symlink(ResultsIn(temp / "elsewhere"), ResultsIn(temp / "moved"));
  orphan([&] { ResultReader reader(temp / "moved"); });
  orphan([&] { WriteStore(temp / "moved", kFew); });
  fs::remove(ResultsIn(temp / "moved"));
  fs::rename(ResultsIn(temp / "elsewhere"), ResultsIn(temp / "moved"));
  EXPECT_EQ(ResultReader(temp / "moved").CountMissions(), 1);
}

// Killed before the mark of a session is in the file: at once, or after all that it did while somebody was reading.
TEST(JournalsTest, ALogThatBeginsWithAMarkIsOfItsFile) {
  const TempDir temp;
  WriteStore(temp / "run", kFew);
  Connection reader(ResultsIn(temp / "run"), Connection::Access::kReadWrite);
  reader.Execute("PRAGMA journal_mode = WAL; BEGIN");
  ASSERT_EQ(reader.Int("SELECT count(*) FROM missions"), 2);
  const auto store = ResultStore::Open(temp / "run", TestRecipe(), TestLayout());
  CopyAsKilled(temp / "run", temp / "at once");
  EXPECT_EQ(ResultReader(temp / "at once").CountMissions(), 2);
  store->Put(kNotFlown, TestRecord(kNotFlown), 0.25);
  store->Commit();
  CopyAsKilled(temp / "run", temp / "later");
  EXPECT_EQ(ResultReader(temp / "later").CountMissions(), 3);
  WriteStore(temp / "later", kMore);
  EXPECT_TRUE(ResultReader(temp / "later").FindDamage().empty());
}

// The system's memory opens like a file, and its first bytes fail as those of a broken disk do. Taken for no journal, it would
// be left for SQLite to find later.
TEST(JournalsTest, AJournalThatCannotBeReadIsNotTakenForNone) {
  const TempDir temp;
  fs::create_directories(temp / "run");
  const std::string file = ResultsIn(temp / "run");
  for (const char* suffix : {"-wal", "-journal"}) {
    fs::create_symlink("/proc/self/mem", file + suffix);
    try {
      CheckNoJournals(file, "its owner");
      ADD_FAILURE() << suffix << " was taken for none";
    } catch (const StoreError& error) {
      EXPECT_EQ(std::string(error.what()), file + suffix + ": cannot be read: Input/output error");
    }
    fs::remove(file + suffix);
  }
  CheckNoJournals(file, "its owner");
}

TEST(JournalsTest, EachSessionHasItsMark) {
  std::set<std::int64_t> marks;
  for (int i = 0; i < 100; ++i) marks.insert(DrawMark());
  EXPECT_GT(marks.size(), 90u);
}

}  // namespace
}  // namespace ed3r::store
