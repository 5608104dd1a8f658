// The file of a run directory, open for writing: lock, checks, journal. Shared by the store and the merge.
#pragma once

#include <memory>
#include <string>

#include "engine/store/directory_lock.h"
#include "engine/store/layout.h"
#include "engine/store/recipe.h"
#include "engine/store/sqlite.h"

namespace ed3r {

// While it is open, the file is in WAL mode: readers of other processes see every commit and never wait.
// Closing brings it back to one plain file, unless a reader is still looking (then the next session does).
class StoreFile {
 public:
  // Makes DIR and the file when missing. UserError, and nothing changed, when the file holds the results of
  // another recipe or layout, is not a store, or has another writer; results of other code are taken on and their
  // recipe then names both where `other_code` accepts it.
  StoreFile(const std::string& dir, const Recipe& recipe, const RunLayout& layout,
            OtherCode other_code = OtherCode::kRefuse);
  ~StoreFile();
  StoreFile(const StoreFile&) = delete;
  StoreFile& operator=(const StoreFile&) = delete;

  Connection& database() { return *database_; }
  bool created() const { return created_; }

  // Takes away what this object created: the file, and the directory when it is empty then. For a merge into
  // a new directory that is refused.
  void Discard();

 private:
  void OpenOrCreate(const Recipe& recipe, const RunLayout& layout, OtherCode other_code);

  std::string dir_;
  bool created_dir_ = false;
  bool created_ = false;
  std::unique_ptr<DirectoryLock> lock_;  // outlives the connection
  std::unique_ptr<Connection> database_;
};

}  // namespace ed3r
