#include "engine/store/store_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "engine/core/check.h"
#include "engine/store/file_system.h"
#include "engine/store/growth.h"
#include "engine/store/journals.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/sqlite_errors.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

// Rows of 300-400 bytes: 16 KiB hold about forty, and the tree stays three levels deep.
constexpr int kPageBytes = 16384;
constexpr int kCacheKib = 64 * 1024;
// A commit waits for readers where there is no WAL: a report may read for minutes.
constexpr int kSharedBusyTimeout_ms = 600 * 1000;

std::string FileIn(const std::string& dir) { return (fs::path(dir) / kResultsFile).string(); }

// The first directory of the path that had to be made; "" where all was there.
std::string MakeDirectory(const std::string& dir) {
  std::error_code error;
  fs::path missing;
  for (fs::path path = fs::absolute(dir).lexically_normal(); !path.empty() && !fs::exists(path, error);
       path = path.parent_path())
    if (path.has_filename()) missing = path;
  fs::create_directories(dir, error);
  if (error) throw UserError(fmt::format("{}: {}", dir, error.message()));
  return missing.string();
}

// " (process 4711 on node3 since 2026-01-01T12:00:00Z)", as far as the file tells.
std::string Holder(const std::string& dir) {
  try {
    const std::vector<Session> sessions = ResultReader(dir).Sessions();
    if (!sessions.empty() && sessions.back().ended_utc.empty())
      return fmt::format(" (process {} on {} since {})", sessions.back().process, sessions.back().host,
                         sessions.back().begun_utc);
  } catch (const std::exception&) {  // the other process may be just about to create it
  }
  return "";
}

[[noreturn]] void FailOwned(const std::string& dir, const std::string& owner) {
  throw UserError(
      fmt::format("{}: another ed3r is writing into this directory ({}); if it is gone for good, remove {}",
                  dir, owner, (fs::path(dir) / kOwnerFile).string()));
}

// What the file's own arms were flown by: more arms may need more code.
CodeIdentities CodeOfBoth(const CodeIdentities& there, CodeIdentities here) {
  std::erase_if(here, [&](const auto& entry) { return !there.contains(entry.first); });
  return here;
}

// "" where the recipes are the same, or how this one grows what is there.
std::string CheckSameRun(Connection& database, const std::string& dir, const Recipe& recipe,
                         const RunLayout& layout, const Taking& taking) {
  const Recipe there = ReadRecipe(database);
  const bool same_plan = there.plan_text == recipe.plan_text;
  const Growth growth = same_plan ? Growth{Difference(there, recipe).value_or(""), ""}
                                  : GrowthOf(there, recipe, LearnedStages(database, ReadLayout(database)));
  if (!growth.Allowed())
    throw UserError(
        fmt::format("{}: holds results of another recipe: {}; give another --out, or remove that folder", dir,
                    growth.difference));
  const auto code = CodeDifference(there.code, same_plan ? recipe.code : CodeOfBoth(there.code, recipe.code));
  if (code && taking.other_code == OtherCode::kRefuse)
    throw UserError(
        fmt::format("{}: holds results of another recipe: {}; give another --out, or --accept-mixed to "
                    "continue it with other code",
                    dir, *code));
  if (same_plan && !ReadLayout(database).SameMissions(layout))
    throw UserError(fmt::format(
        "{}: holds results of other stages, arms or seed; give another --out, or remove that folder", dir));
  if (!growth.what.empty() && !taking.may_grow)
    throw UserError(fmt::format(
        "{}: --only-failed flies nothing that is missing, and the plan asks for more than is there ({}); "
        "leave --only-failed out, or give the plan that is there",
        dir, growth.what));
  return growth.what;
}

// Two writers by two names would each have a journal of their own, and a copy that was made by a link would change with the run.
void CheckOneName(const std::string& file) {
  std::error_code absent;
  const std::uintmax_t names = fs::hard_link_count(file, absent);
  if (!absent && names > 1 && fs::is_regular_file(file, absent))
    throw UserError(fmt::format(
        "{}: this file has {} names (hard links), and writing by one would change or damage what the others "
        "show; give it a file of its own (cp FILE COPY, mv COPY FILE)",
        file, names));
}

}  // namespace

StoreFile::StoreFile(const std::string& dir, const Recipe& recipe, const RunLayout& layout,
                     const Taking& taking)
    : dir_(dir) {
  CheckPathLength(FileIn(dir));
  static_cast<void>(SaidToBeShared());  // what it refuses is refused before anything is made
  first_created_dir_ = MakeDirectory(dir);
  Lock();
  created_ = !fs::exists(FileIn(dir));
  CheckOneName(FileIn(dir));
  try {
    OpenOrCreate(recipe, layout, taking);
  } catch (const SharedMemoryError&) {
    rollback_journal_ = true;
    OpenOrCreate(recipe, layout, taking);
  }
}

// Where the file itself lies: run directories may link to one file.
void StoreFile::Lock() {
  const std::string place = PlaceOf(dir_);
  if (!IsSharedFileSystem(place)) {
    DirectoryLock::Attempt attempt = DirectoryLock::TryLock(place);
    if (attempt.lock) {
      lock_ = std::make_unique<DirectoryLock>(std::move(*attempt.lock));
      return;
    }
    if (attempt.supported)
      throw UserError(fmt::format("{}: another ed3r is writing into this directory{}", place, Holder(dir_)));
  }
  std::string owner;
  owner_ = OwnerFile::TryTake(place, owner);
  if (!owner_) FailOwned(place, owner);
  rollback_journal_ = true;
}

void StoreFile::CheckOwned() const {
  if (owner_ && owner_->Lost())
    throw StoreError(
        fmt::format("{}: another ed3r has taken this directory over; what is stored is kept", dir_));
}

void StoreFile::CheckInPlace() {
  const auto state = marks_.empty() ? std::nullopt : database_->StateOfFile();
  const bool written_over = state && std::none_of(marks_.begin(), marks_.end(), [&](std::int64_t own) {
                              return IsSameMark(own, state->mark);
                            });
  if (written_over) database_->LeaveLog();  // else it would be written into what is there now
  if (written_over || database_->HasMoved())
    throw StoreError(fmt::format(
        "{}: was taken away, or another file put in its place, while it was written to: what this "
        "run has stored is not in it; the same command continues with what is there",
        FileIn(dir_)));
  if (marks_.empty()) return;  // no log
  struct stat log = {};
  const bool there = stat((ResultsFileOf(dir_) + "-wal").c_str(), &log) == 0;
  if (log_inode_ == 0 && there) log_inode_ = log.st_ino;
  // What it holds is written into the file when this connection is closed.
  if (log_inode_ != 0 && (!there || log.st_ino != log_inode_))
    throw StoreError(fmt::format(
        "{}-wal: was taken away while it was written to, where readers look and a kill leaves what "
        "is stored; the same command continues",
        FileIn(dir_)));
}

void StoreFile::Connect() {
  database_.reset();  // the one before, of the other journal
  database_ = std::make_unique<Connection>(FileIn(dir_), Connection::Access::kCreate);
  if (!rollback_journal_) return;
  database_->SetBusyTimeout(kSharedBusyTimeout_ms);
  // A file that was left in WAL mode is opened without shared memory in this mode.
  database_->Execute("PRAGMA locking_mode = EXCLUSIVE");
}

void StoreFile::SetJournal(bool empty) {
  if (empty) database_->Execute(fmt::format("PRAGMA page_size = {}", kPageBytes));
  const std::string mark = fmt::format("PRAGMA schema_version = {}", DrawMark());
  if (rollback_journal_) {
    // The lock is given back with the next commit, so that readers get their turn between commits.
    database_->Execute(
        "PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL; PRAGMA locking_mode = NORMAL");
    marks_.clear();
    database_->Execute(
        mark);  // not before: it would wait for another writer while that one waits for its lock
    return;
  }
  const auto before = database_->StateOfFile();
  // Not within a log of its own: where that is lost, the file has its mark.
  const bool takes_up_a_log = database_->Text("PRAGMA journal_mode") == "wal";
  if (!takes_up_a_log) database_->Execute(mark);
  database_->Execute("PRAGMA journal_mode = WAL");
  // The log begins with the file's own mark: a kill may come before the new one is in the file, or a reader keep it out.
  if (takes_up_a_log)
    database_->Execute(fmt::format("PRAGMA schema_version = {}; {}; PRAGMA wal_checkpoint(TRUNCATE)",
                                   database_->Int("PRAGMA schema_version"), mark));
  marks_ = {database_->Int("PRAGMA schema_version")};
  if (takes_up_a_log && before) marks_.push_back(before->mark);
  // A commit outlives the process at once, and a power cut costs the last commits but never the file.
  database_->Execute("PRAGMA synchronous = NORMAL");
}

// Before anything is written: a run that is refused stays as it was, and what is in no plan would get another's number.
void StoreFile::CheckBeforeGrowth(Repair repair) {
  repaired_ = FindDamage(*database_, ReadLayout(*database_));
  if (repaired_.empty()) return;
  if (repair == Repair::kNo) throw UserError(DamageText(database_->file(), repaired_.front()));
  if (repair == Repair::kOfAPart)
    throw UserError(
        fmt::format("{}: {} is damaged: {}; where a plan grows --repair goes without --stage, --shard and "
                    "--only-failed, or repair it by the plan that it has",
                    database_->file(), repaired_.front().name, repaired_.front().what));
  RemoveMissions(*database_, repaired_);
}

void StoreFile::OpenOrCreate(const Recipe& recipe, const RunLayout& layout, const Taking& taking) {
  Connect();
  empty_ = CheckFile(*database_, FileUse::kWrite) == FileKind::kEmpty;
  if (!empty_) grown_ = CheckSameRun(*database_, dir_, recipe, layout, taking);
  SetJournal(empty_);  // only now: a refused file stays as it was
  database_->Execute(fmt::format("PRAGMA cache_size = -{}", kCacheKib));
  database_->Execute("PRAGMA secure_delete = OFF");  // Debian's default wipes freed space
  // Also for its own sake: what a file system cannot do for a writer shows now, where another journal can still be taken.
  Transaction transaction(*database_, Transaction::Kind::kWrite);
  if (!grown_.empty()) CheckBeforeGrowth(taking.repair);
  if (!repaired_.empty()) transaction.Commit();
}

void StoreFile::TakeUp(const Recipe& recipe, const RunLayout& layout) {
  if (empty_)
    CreateTables(*database_, recipe, layout);
  else if (grown_.empty())
    ContinueRecipe(*database_, recipe);
  else
    Grow(*database_, recipe, layout);
  AddFailureKind(*database_);
  CreateMissionsIndex(*database_);
}

StoreFile::~StoreFile() {
  if (!database_ || rollback_journal_) return;
  try {
    CheckInPlace();
    database_->SetBusyTimeout(0);  // a reader that is still looking is not waited for
    database_->Execute("PRAGMA wal_checkpoint(TRUNCATE); PRAGMA journal_mode = DELETE");
  } catch (const std::exception&) {  // stays in WAL mode, which is as safe
  }
}

void FinishCommit(const std::string& dir) {
  std::string owner;
  const std::unique_ptr<OwnerFile> alone = OwnerFile::TryTake(PlaceOf(dir), owner);
  if (!alone) FailOwned(PlaceOf(dir), owner);
  Connection database(FileIn(dir), Connection::Access::kReadWrite);
  database.Int("SELECT count(*) FROM sqlite_schema");  // any read rolls back
}

void StoreFile::Discard() {
  if (!created_) return;
  database_.reset();
  std::error_code ignored;
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(FileIn(dir_) + suffix, ignored);
  lock_.reset();
  owner_.reset();
  if (first_created_dir_.empty()) return;
  const fs::path end = fs::path(first_created_dir_).parent_path();
  fs::path path = fs::absolute(dir_).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  for (; path != end && fs::remove(path, ignored); path = path.parent_path()) {
  }
}

}  // namespace ed3r::store
