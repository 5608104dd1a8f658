// The file of a run directory, open for writing: lock, checks, journal. Shared by the store and the merge.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/store/damage.h"
#include "engine/store/directory_lock.h"
#include "engine/store/layout.h"
#include "engine/store/owner_file.h"
#include "engine/store/recipe.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// What may become of a file that is there.
struct Taking {
  OtherCode other_code = OtherCode::kRefuse;
  Repair repair = Repair::kNo;
  bool may_grow = true;
};

// While it is open on a disk of this machine, the file is in WAL mode: readers of other processes see every commit and never
// wait. Closing brings it back to one plain file, unless a reader is still looking (then the next session does).
// Where several machines may see the directory, or the file system has no locks or no shared memory for it, the file is
// written with a rollback journal instead (readers wait for a commit, and commits for readers), and an owner file keeps other
// writers away (file_system.h, owner_file.h).
class StoreFile {
 public:
  // Makes DIR and the file when missing, without tables yet: TakeUp does the rest. UserError, and nothing changed, when the
  // file holds the results of another recipe or layout, is not a store, has another name (a hard link: SQLite's journals go
  // by name), or has another writer; results of other code are taken on where `taking` accepts it. A recipe that asks for more
  // of the same may grow the file (growth.h), unless there are damaged missions in it: UserError, or they are taken out at once
  // with Repair::kYes.
  StoreFile(const std::string& dir, const Recipe& recipe, const RunLayout& layout, const Taking& taking = {});
  ~StoreFile();
  StoreFile(const StoreFile&) = delete;
  StoreFile& operator=(const StoreFile&) = delete;

  Connection& database() { return *database_; }
  bool created() const { return created_; }
  // Gives the file the recipe that it was opened with: makes the tables, adds what another code is called, or grows. All of it
  // is the caller's transaction's, so that what is refused after all leaves no trace.
  void TakeUp(const Recipe& recipe, const RunLayout& layout);
  // What TakeUp adds to the plan; "" where it is the same.
  const std::string& grown() const { return grown_; }
  // What was taken out so that it may grow.
  const std::vector<DamagedMission>& repaired() const { return repaired_; }

  // StoreError once another writer has taken the directory over, which it does only when this one seemed dead.
  void CheckOwned() const;
  // StoreError once another file lies in this one's place, or was copied over it, or its log was taken away.
  void CheckInPlace();

  // Takes away what this object created: the file, and the directories that are empty then. For what is refused after all.
  void Discard();

 private:
  void Lock();
  void Connect();
  void SetJournal(bool empty);
  void OpenOrCreate(const Recipe& recipe, const RunLayout& layout, const Taking& taking);
  void CheckBeforeGrowth(Repair repair);

  std::string dir_;
  std::string first_created_dir_;         // of the path that leads to the file; "" where all was there
  bool created_ = false, empty_ = false;  // `empty_`: without tables
  std::string grown_;
  std::vector<DamagedMission> repaired_;
  bool rollback_journal_ = false;
  std::uint64_t log_inode_ = 0;      // of the write-ahead log; 0 before it is there
  std::vector<std::int64_t> marks_;  // that the file may have while this object writes (journals.h)
  // One of the two is held; both outlive the connection.
  std::unique_ptr<DirectoryLock> lock_;
  std::unique_ptr<OwnerFile> owner_;
  std::unique_ptr<Connection> database_;
};

// Rolls back what a killed writer left half committed in DIR, if no writer is alive. UserError otherwise.
void FinishCommit(const std::string& dir);

}  // namespace ed3r::store
