#include "engine/store/finished.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <ctime>
#include <filesystem>

#include "engine/core/check.h"
#include "engine/store/columns.h"
#include "engine/store/directory_lock.h"
#include "engine/store/file_system.h"
#include "engine/store/schema.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNsPerS = 1'000'000'000;

// Of the file's header: raised by every transaction that writes outside of WAL mode. -1 where it cannot be read.
std::int64_t ChangeCounter(const Connection& database) {
  const auto state = database.StateOfFile();
  return state ? std::int64_t{state->changes} : -1;
}

struct FileTimes {
  std::int64_t written_ns = -1, changed_ns = -1;  // the second cannot be set back
};

FileTimes TimesOf(const std::string& file) {
  struct stat found = {};
  if (stat(file.c_str(), &found) != 0) return {};
  return {found.st_mtim.tv_sec * kNsPerS + found.st_mtim.tv_nsec,
          found.st_ctim.tv_sec * kNsPerS + found.st_ctim.tv_nsec};
}

// Between writing that a run is finished and dating the file so.
constexpr std::int64_t kLongestDatingNs = 2 * kNsPerS;

bool IsBeingWritten(const std::string& file) {
  return fs::exists(file + "-wal") || fs::exists(file + "-journal");
}

std::string ChecksumOf(const FinishedRun& run) {
  std::string bytes;
  for (const std::string& text : {run.made_by, std::to_string(run.missions), run.table, run.networks})
    AppendText(bytes, text);
  return HashOf(bytes);
}

// Since the run was flown another process may have grown it, or put another file in its place.
bool Holds(const std::string& file, const std::string& plan_text, const FinishedRun& run) {
  Connection database(file, Connection::Access::kReadOnly);
  return ReadRecipe(database).plan_text == plan_text &&
         database.Int("SELECT count(*) FROM missions NOT INDEXED") == run.missions &&
         database.Int("SELECT count(*) FROM failures") == 0;
}

void Write(const std::string& file, const FinishedRun& run) {
  timespec now = {};
  clock_gettime(CLOCK_REALTIME, &now);
  {
    Connection database(file, Connection::Access::kReadWrite);
    const std::int64_t counter = ChangeCounter(database) + 1;
    if (database.Text("PRAGMA journal_mode") == "wal") return;  // a reader is still looking
    Transaction transaction(database, Transaction::Kind::kWrite);
    database.Execute(
        "DROP TABLE IF EXISTS finished; CREATE TABLE finished (made_by TEXT NOT NULL, change_counter INTEGER "
        "NOT NULL, "
        "written_ns INTEGER NOT NULL, missions INTEGER NOT NULL, results TEXT NOT NULL, networks TEXT NOT "
        "NULL, checksum TEXT NOT NULL) STRICT");
    Statement put(database, "INSERT INTO finished VALUES (?, ?, ?, ?, ?, ?, ?)");
    put.Run(run.made_by, counter, now.tv_sec * kNsPerS + now.tv_nsec, run.missions, run.table, run.networks,
            ChecksumOf(run));
    transaction.Commit();
  }
  const timespec times[2] = {now, now};
  utimensat(AT_FDCWD, file.c_str(), times, 0);
}

}  // namespace

FileMoment LookAtFile(const std::string& dir) {
  const std::string file = ResultsFileOf(dir);
  struct stat found = {};
  if (stat(file.c_str(), &found) != 0) return {};
  return {static_cast<std::int64_t>(found.st_dev), static_cast<std::int64_t>(found.st_ino), found.st_size,
          ChangeCounter(Connection(file, Connection::Access::kReadOnly))};
}

void RememberFinished(const std::string& dir, const FileMoment& told, const std::string& plan_text,
                      const FinishedRun& run) {
  const std::string file = ResultsFileOf(dir);
  if (IsSharedFileSystem(PlaceOf(dir))) return;
  const DirectoryLock::Attempt alone = DirectoryLock::TryLock(PlaceOf(dir));
  if (alone.lock && !IsBeingWritten(file) && LookAtFile(dir) == told && Holds(file, plan_text, run))
    Write(file, run);
}

std::optional<FinishedRun> RecallFinished(const std::string& dir, const std::string& made_by) {
  const std::string file = ResultsFileOf(dir);
  if (!fs::exists(file) || IsBeingWritten(file)) return std::nullopt;
  Connection database(file, Connection::Access::kReadOnly);
  if (database.Int("SELECT count(*) FROM pragma_table_info('finished') WHERE name = 'checksum'") == 0)
    return std::nullopt;
  Statement select(database,
                   "SELECT change_counter, written_ns, missions, results, networks, checksum FROM finished "
                   "WHERE made_by = ?");
  select.Bind(0, made_by);
  const FileTimes times = TimesOf(file);
  if (!select.Step() || select.Int(0) != ChangeCounter(database) || select.Int(1) != times.written_ns ||
      times.changed_ns - times.written_ns > kLongestDatingNs)
    return std::nullopt;
  FinishedRun run{made_by, select.Int(2), select.Text(3), select.Text(4)};
  if (select.Text(5) != ChecksumOf(run)) return std::nullopt;
  return run;
}

}  // namespace ed3r::store
